"""Recordings, episodes and setups by the beginning of an id or a digest, as people type them."""

from __future__ import annotations

import re
from uuid import UUID

from sqlalchemy import Column, ColumnElement, Table, or_, select

from palpate.errors import choices
from palpate.store import schema
from palpate.store.errors import StoreError
from palpate.store.legible import reading
from palpate.store.store import Store

__all__ = ["episode_id", "recording_id", "setup_digest"]

ID_DIGITS, DIGEST_DIGITS = 32, 64
SHOWN = 5
"""Of those that begin alike, so many are named."""


def recording_id(store: Store, text: str) -> UUID:
    """The id of the one recording whose id or digest begins so.

    Raises
    ------
    StoreError
        If there is none, or there are several.

    Examples
    --------
    ::

        recording = store.get(recording_id(store, "3fa85f64"))
    """
    return UUID(bytes=_found(store, "recording", schema.recordings, text)["uuid"])


def episode_id(store: Store, text: str) -> UUID:
    """The id of the one episode whose id or digest begins so; raises as `recording_id` does."""
    return UUID(bytes=_found(store, "episode", schema.episodes, text)["uuid"])


def setup_digest(store: Store, text: str) -> str:
    """The digest of the one setup whose digest begins so; raises as `recording_id` does."""
    return _found(store, "setup", schema.setups, text)["digest"].hex()


def _found(store: Store, what: str, table: Table, text: str) -> dict[str, bytes]:
    names = {"uuid": ID_DIGITS, "digest": DIGEST_DIGITS} if "uuid" in table.c else {"digest": DIGEST_DIGITS}
    digits = text.replace("-", "").casefold()
    if not re.fullmatch("[0-9a-f]{1,64}", digits):
        kinds = "of an id or a digest" if "uuid" in names else "of a digest"
        raise StoreError(f"{what} {text!r}: is not the beginning {kinds}, expected hexadecimal digits")
    fitting = {name: table.c[name] for name, most in names.items() if len(digits) <= most}
    between = [_begins(column, digits, names[name]) for name, column in fitting.items()]
    asked = select(*(table.c[name] for name in names)).where(or_(*between)).order_by(table.c.id).limit(SHOWN + 1)
    with reading(store.engine) as connection:
        rows = [dict(row) for row in connection.execute(asked).mappings()]
    if not rows:
        raise StoreError(f"{what} {text}: is not in the store")
    if len(rows) > 1:
        several = f"{'more than ' if len(rows) > SHOWN else ''}{min(len(rows), SHOWN)} begin so"
        raise StoreError(f"{what} {text}: {several}; {choices(_key(row, digits) for row in rows[:SHOWN])}")
    return rows[0]


def _begins(column: Column[bytes], digits: str, most: int) -> ColumnElement[bool]:
    """The condition that bytes begin with these digits, which an index can answer."""
    low, high = (bytes.fromhex(digits.ljust(most, end)) for end in "0f")
    return column.between(low, high)


def _key(row: dict[str, bytes], digits: str) -> str:
    """What of a row begins with the digits, whole."""
    if "uuid" in row and row["uuid"].hex().startswith(digits):
        return str(UUID(bytes=row["uuid"]))
    return row["digest"].hex()
