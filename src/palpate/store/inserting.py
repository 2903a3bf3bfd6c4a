"""The statements that putting a recording takes, worked out once and sent by the driver itself.

SQLAlchemy takes longer to send a statement than SQLite takes to carry it out, and each recording needs several. What is
here holds for plain types only, which need no conversion on their way to the driver and back. Errors are the driver's,
but for lost servers and damaged files.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from operator import itemgetter
from typing import Any

from sqlalchemy import Engine, PoolProxiedConnection, Table
from sqlalchemy.engine.interfaces import DBAPICursor

from palpate.store.chunks import chunks
from palpate.store.outages import is_gone, outage
from palpate.store.upload_order import DRAW

__all__ = ["Statements"]


class Statements:
    """What is sent to one database.

    Parameters
    ----------
    engine
        Gives connections; others may use it at the same time.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._is_postgresql = engine.dialect.name == "postgresql"

    @contextmanager
    def transaction(self) -> Iterator[DBAPICursor]:
        """A transaction that writes; it is rolled back where the block raises.

        Raises
        ------
        LostError
            If the server went away; what was being committed may or may not be there.
        DamagedError
            If the file is damaged.
        """
        connection = self._connection()
        try:
            cursor = connection.cursor()
            if not self._is_postgresql:
                # see `palpate.store.database`: a writer says so at once
                cursor.execute("BEGIN IMMEDIATE")
            yield cursor
            connection.commit()
        except self._engine.dialect.loaded_dbapi.Error as error:
            lost = self._engine.dialect.is_disconnect(error, connection, None) or is_gone(error)
            if lost:
                connection.invalidate(error)
            self._raise_outage(error, lost=lost)
            raise
        finally:
            # what was not committed is rolled back before another gets the connection
            connection.close()

    def _connection(self) -> PoolProxiedConnection:
        try:
            return self._engine.raw_connection()
        except self._engine.dialect.loaded_dbapi.Error as error:
            self._raise_outage(error, lost=True)
            raise

    def _raise_outage(self, error: BaseException, *, lost: bool) -> None:
        told = outage(self._engine, error, lost=lost)
        if told is not None:
            raise told from None

    def insert(self, cursor: DBAPICursor, table: Table, rows: Sequence[Mapping[str, Any]]) -> None:
        """Insert rows that have a value for every column."""
        if not rows:
            return
        statement, values_of = _insert(table, self._mark)
        if len(rows) == 1:
            cursor.execute(statement, values_of(rows[0]))
        else:
            cursor.executemany(statement, [values_of(row) for row in rows])

    def present(
        self, cursor: DBAPICursor, digests: Sequence[bytes], ids: Sequence[bytes]
    ) -> Iterator[tuple[bytes, bytes]]:
        """Id and digest of each recording that has one of these digests or one of these ids, as many of each."""
        for some, theirs in zip(chunks(digests), chunks(ids), strict=True):
            part = (*some, *theirs)
            cursor.execute(_present(len(part) // 2, self._mark), part)
            yield from cursor.fetchall()

    def units(self, cursor: DBAPICursor, names: Sequence[str]) -> dict[str, str]:
        """Property to the unit that decides its dimension, for those of these names that have one."""
        found: dict[str, str] = {}
        for some in chunks(names):
            part = tuple(some)
            cursor.execute(_units(len(part), self._mark), part)
            found.update(cursor.fetchall())
        return found

    def new_ids(self, cursor: DBAPICursor, count: int) -> Sequence[int]:
        """Row numbers for recordings, known before they are inserted, so that all their rows go in at once."""
        if self._is_postgresql:
            # a sequence is safe while others insert
            cursor.execute(DRAW, (count,))
            return [row for (row,) in cursor.fetchall()]
        # in SQLite there is one writer at a time
        cursor.execute("SELECT max(id) FROM recordings")
        ((last,),) = cursor.fetchall()
        return range((last or 0) + 1, (last or 0) + 1 + count)

    @property
    def _mark(self) -> str:
        return "%s" if self._is_postgresql else "?"


@lru_cache(maxsize=64)
def _insert(table: Table, mark: str) -> tuple[str, Callable[[Mapping[str, Any]], Any]]:
    """The statement, and what takes its parameters from a row."""
    names = [column.name for column in table.columns]
    columns = ", ".join(f'"{name}"' for name in names)
    return f"INSERT INTO {table.name} ({columns}) VALUES ({_marks(len(names), mark)})", itemgetter(*names)


@lru_cache(maxsize=64)
def _present(count: int, mark: str) -> str:
    marks = _marks(count, mark)
    return f"SELECT uuid, digest FROM recordings WHERE digest IN ({marks}) OR uuid IN ({marks})"


@lru_cache(maxsize=64)
def _units(count: int, mark: str) -> str:
    return f"SELECT name, unit FROM properties WHERE name IN ({_marks(count, mark)})"


def _marks(count: int, mark: str) -> str:
    return ", ".join([mark] * count)
