"""How long tokens hold, by which sessions of browsers are told from tokens of programs."""

from __future__ import annotations

from sqlalchemy import ColumnElement

from palpate.store import schema

__all__ = ["MICROSECONDS_PER_DAY", "SESSION_DAYS", "SESSION_US", "is_of_session", "lasts_as_session"]

MICROSECONDS_PER_DAY = 86_400_000_000
SESSION_DAYS = 0.5
SESSION_US = int(SESSION_DAYS * MICROSECONDS_PER_DAY)
"""A session, what a browser gets where somebody logs in, is made for exactly as long, and no other token is."""


def lasts_as_session(created_us: int, expires_us: int | None) -> bool:
    """Whether a token that was made then is a session: `is_of_session` of one that was read."""
    return expires_us is not None and expires_us - created_us == SESSION_US


def is_of_session() -> ColumnElement[bool]:
    """The condition that a token is a session."""
    columns = schema.tokens.c
    return columns.expires_us.is_not(None) & (columns.expires_us - columns.created_us == SESSION_US)
