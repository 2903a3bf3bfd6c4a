"""The statements of every put, worked out once and handed to the driver as they are.

Building a statement, or its result, takes longer than SQLite takes to carry it out: here statements are strings that
are remembered. It holds for plain types only, which need no conversion on their way to the driver and back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from sqlalchemy import Connection, Table, insert
from sqlalchemy.engine import Dialect

__all__ = ["insert_rows", "present_rows"]

# SQLite takes so many parameters in one statement, and more
CHUNK = 400


def insert_rows(connection: Connection, table: Table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Insert rows that have a value for every column.

    Errors are the driver's own.
    """
    if not rows:
        return
    statement, order = _statement(table, connection.dialect)
    values: list[Any] = [row if order is None else tuple(map(row.__getitem__, order)) for row in rows]
    cursor = _cursor(connection)
    if len(values) == 1:
        cursor.execute(statement, values[0])
    else:
        cursor.executemany(statement, values)
    cursor.close()


def present_rows(connection: Connection, digests: Sequence[bytes], ids: Sequence[bytes]) -> list[tuple[bytes, bytes]]:
    """Id and digest of each recording that has one of these digests or one of these ids.

    Errors are the driver's own.
    """
    found: list[tuple[bytes, bytes]] = []
    mark = "?" if connection.dialect.name == "sqlite" else "%s"
    cursor = _cursor(connection)
    for start in range(0, len(digests), CHUNK):
        part = (*digests[start : start + CHUNK], *ids[start : start + CHUNK])
        cursor.execute(_present(mark, len(part) // 2), part)
        found += cursor.fetchall()
    cursor.close()
    return found


@lru_cache(maxsize=2 * CHUNK)
def _present(mark: str, count: int) -> str:
    marks = ", ".join([mark] * count)
    return f"SELECT uuid, digest FROM recordings WHERE digest IN ({marks}) OR uuid IN ({marks})"


def _cursor(connection: Connection) -> Any:
    driver = connection.connection.driver_connection
    assert driver is not None
    return driver.cursor()


@lru_cache(maxsize=64)
def _statement(table: Table, dialect: Dialect) -> tuple[str, Sequence[str] | None]:
    """The statement, and the order of its parameters where they have no names."""
    compiled = insert(table).compile(dialect=dialect, column_keys=[column.name for column in table.columns])
    order = getattr(compiled, "positiontup", None)
    return str(compiled), order
