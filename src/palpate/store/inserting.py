"""Inserting rows with statements that are worked out once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from sqlalchemy import Connection, Table, insert
from sqlalchemy.engine import Dialect

__all__ = ["insert_rows"]


def insert_rows(connection: Connection, table: Table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Insert rows that have a value for every column.

    Building a statement takes longer than SQLite takes to insert a row: here it is a string that is remembered. It
    holds for plain types only, which need no conversion on their way to the driver.
    """
    if not rows:
        return
    statement, order = _statement(table, connection.dialect)
    values: list[Any] = [row if order is None else tuple(map(row.__getitem__, order)) for row in rows]
    connection.exec_driver_sql(statement, values)


@lru_cache(maxsize=64)
def _statement(table: Table, dialect: Dialect) -> tuple[str, Sequence[str] | None]:
    """The statement, and the order of its parameters where they have no names."""
    compiled = insert(table).compile(dialect=dialect, column_keys=[column.name for column in table.columns])
    order = getattr(compiled, "positiontup", None)
    return str(compiled), order
