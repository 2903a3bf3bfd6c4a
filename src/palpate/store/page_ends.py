"""Where a page of recordings or of explorations ends, so that the next one begins after it.

Rows are numbered as they come: numbers tell how many there are, and stand in cursors only of who sees all of them.
Those of others name the last row by its id.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Table, select

from palpate.store.cursors import cursor_text, place_of
from palpate.store.errors import DamagedError, StoreError
from palpate.store.filters import Sort
from palpate.store.viewing import Viewer

__all__ = ["Lists", "PageEnd"]


@dataclass(frozen=True)
class PageEnd:
    """The place of a page's last row in the sorting, and its row number, which makes it unique."""

    value: int | str
    row: int


@dataclass(frozen=True)
class Lists:
    """The lists of a table in one order, as somebody sees them."""

    table: Table
    sort: Sort
    column: str
    viewer: Viewer

    def cursor_after(self, end: PageEnd, row: Mapping[Any, Any] | DamagedError) -> str:
        """The text that leads on from a row of the table; only who sees all is led on from one that is damaged."""
        if self.viewer.everything:
            return cursor_text([*self._order, end.value, end.row])
        if isinstance(row, DamagedError):
            raise row
        return cursor_text([*self._order, UUID(bytes=row["uuid"]).hex])

    def end_at(self, connection: Connection, cursor: str) -> PageEnd:
        """Where a cursor leads on from.

        Raises
        ------
        StoreError
            If it is none of a list like this, or of a row that is not seen any more.
        """
        found = place_of(cursor) or []
        kinds = [str if self.sort.by == "action" else int, int] if self.viewer.everything else [str]
        if found[:2] != self._order or [type(part) for part in found[2:]] != kinds:
            raise self._foreign(cursor)
        return PageEnd(*found[2:]) if self.viewer.everything else self._end_named(connection, cursor, found[2])

    @property
    def _order(self) -> list[object]:
        return [self.sort.by, self.sort.descending]

    def _end_named(self, connection: Connection, cursor: str, name: str) -> PageEnd:
        try:
            uuid = UUID(hex=name).bytes
        except ValueError:
            raise self._foreign(cursor) from None
        columns = self.table.c
        asked = select(columns[self.column], columns.id).where(columns.uuid == uuid, self.viewer.of(self.table))
        found = connection.execute(asked).first()
        if found is None:
            raise StoreError(f"cursor: {cursor!r} is of a row that is not there to see, begin the list again")
        return PageEnd(*found)

    @staticmethod
    def _foreign(cursor: str) -> StoreError:
        return StoreError(f"cursor: {cursor!r} is not of a list sorted like this, expected the cursor of its last page")
