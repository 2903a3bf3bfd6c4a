"""Objects of which some are damaged: each is looked at alone, so that one hides no other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from sqlalchemy import Connection, select

from palpate.store import schema
from palpate.store.errors import DamagedError, IncompleteError
from palpate.store.listing import Damaged

__all__ = ["each_thing"]

T = TypeVar("T")


def each_thing(
    connection: Connection, rows: Iterable[int], read: Callable[[int], T], damaged: Damaged
) -> Iterator[tuple[int, T]]:
    """What is read of the object of each row number; those that are damaged are left out, and told by their names.

    Raises
    ------
    IncompleteError
        If tables are missing.
    """
    for row in rows:
        try:
            yield row, read(row)
        except IncompleteError:
            raise
        except DamagedError as error:
            name = _name(connection, row)
            damaged(DamagedError(f"{name}: {str(error).removeprefix(f'{name}: ')}"))


def _name(connection: Connection, row: int) -> str:
    columns = schema.things.c
    try:
        found = connection.execute(select(columns.dataset, columns.name).where(columns.id == row)).one()
    except DamagedError:
        return f"object of row {row}"
    return f"object {found.dataset}/{found.name}"
