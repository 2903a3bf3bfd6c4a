"""How long tokens hold, by which sessions of browsers are told from tokens of programs."""

from __future__ import annotations

from sqlalchemy import ColumnElement

from palpate.store import schema

__all__ = ["LONGEST_SESSION_US", "MICROSECONDS_PER_DAY", "SESSION_DAYS", "is_of_session"]

MICROSECONDS_PER_DAY = 86_400_000_000
SESSION_DAYS = 0.5
"""A token made for no longer is a session: what a browser gets where somebody logs in."""
LONGEST_SESSION_US = int(SESSION_DAYS * MICROSECONDS_PER_DAY)


def is_of_session() -> ColumnElement[bool]:
    """The condition that a token is a session."""
    columns = schema.tokens.c
    return columns.expires_us.is_not(None) & (columns.expires_us - columns.created_us <= LONGEST_SESSION_US)
