"""What must be done at least, by bare calls and in the same run: what the figures are compared with.

To keep a recording, its samples must be hashed and compressed and its rows inserted, at whatever a commit costs on this
disk; to spool it, its files must be written, and renamed when they are whole.
"""

import fcntl
import os
import sqlite3
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from typing import Any

import psycopg
import zstandard
from sqlalchemy.engine.interfaces import DBAPICursor

from palpate.store.opening import open_store
from palpate.store.records import Recording

SHARED, OWN = ("things", "setups", "layouts"), ("recordings", "series", "entries")
TABLES = (*SHARED, *OWN)


class BareCommits:
    """Commits of one row, in SQLite with synchronous=FULL or in PostgreSQL."""

    def __init__(self, stack: ExitStack, place: Path | str) -> None:
        connection: Any
        if isinstance(place, Path):
            connection = sqlite3.connect(place, isolation_level=None)
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
        else:
            connection = psycopg.connect(place.replace("+psycopg", ""), autocommit=True)
        stack.callback(connection.close)
        self._execute = connection.execute
        self._execute("CREATE TABLE one (number integer)")

    def seconds(self, made: Sequence[Recording]) -> float:
        """Seconds of a commit, for as many as there are recordings."""
        start = perf_counter()
        for _ in made:
            self._execute("INSERT INTO one VALUES (1)")
        return (perf_counter() - start) / len(made)


class LeastPuts:
    """Recordings hashed, compressed, and inserted by sqlite3 alone into the tables of a store."""

    def __init__(self, stack: ExitStack, folder: Path, *, at_once: int, durable: bool) -> None:
        self._source = stack.enter_context(open_store(folder / "source.sqlite", durable=False))
        self._store = stack.enter_context(open_store(folder / "least.sqlite", durable=durable))
        self._at_once = at_once
        self._seen = dict.fromkeys(TABLES, 0)

    def seconds(self, made: Sequence[Recording]) -> float:
        """Seconds for each of the recordings, which are new."""
        self._source.put_many(made)
        rows = {table: self._new_rows(table) for table in TABLES}
        connection = self._store.engine.raw_connection()
        cursor = connection.cursor()
        for table in SHARED:
            _insert(cursor, table, rows[table])
        connection.commit()
        start = perf_counter()
        for first in range(0, len(made), self._at_once):
            cursor.execute("BEGIN IMMEDIATE")
            for table in OWN:
                _insert(cursor, table, rows[table][first : first + self._at_once])
            connection.commit()
        taken = perf_counter() - start
        connection.close()
        return taken / len(made) + least_packing_s(made)

    def _new_rows(self, table: str) -> list[Any]:
        connection = self._source.engine.raw_connection()
        key = "id" if table in (*SHARED, "recordings") else "recording_id"
        cursor = connection.cursor()
        cursor.execute(f"SELECT * FROM {table} WHERE {key} > ? ORDER BY {key}", (self._seen[table],))
        rows = list(cursor.fetchall())
        connection.close()
        # the key is the first column
        self._seen[table] = rows[-1][0] if rows else self._seen[table]
        return rows


def _insert(cursor: DBAPICursor, table: str, rows: Sequence[Sequence[Any]]) -> None:
    if rows:
        cursor.executemany(f"INSERT INTO {table} VALUES ({', '.join('?' * len(rows[0]))})", rows)


def least_packing_s(made: Sequence[Recording]) -> float:
    """Seconds per recording of SHA-256 and zstd of its samples."""
    raw = [b"".join(channel.values.tobytes() for channel in one.series[0].channels) for one in made]
    compressor = zstandard.ZstdCompressor(level=1)
    start = perf_counter()
    for one in raw:
        sha256(one).digest()
        compressor.compress(one)
    return (perf_counter() - start) / len(made)


class LeastSpool:
    """Files of a recording written into a locked folder that is renamed when it is whole."""

    def __init__(self, folder: Path, files: Mapping[str, bytes], *, sync: bool) -> None:
        self._folder, self._files, self._sync = folder, files, sync
        for name in ("locks", "open", "waiting"):
            (folder / name).mkdir(parents=True)

    def seconds(self, number: int) -> float:
        """Seconds of one recording, each with a number of its own."""
        start = perf_counter()
        _spool(str(self._folder), str(number), self._files, sync=self._sync)
        return perf_counter() - start


def _spool(folder: str, name: str, files: Mapping[str, bytes], *, sync: bool) -> None:
    lock = os.open(f"{folder}/locks/{name}", os.O_RDWR | os.O_CREAT)
    fcntl.flock(lock, fcntl.LOCK_EX)
    opened = Path(f"{folder}/open/{name}")
    opened.mkdir()
    for file, content in files.items():
        handle = os.open(f"{opened}/{file}", os.O_WRONLY | os.O_CREAT | os.O_EXCL)
        os.write(handle, content)
        if sync:
            os.fsync(handle)
        os.close(handle)
    places = [str(opened)] if sync else []
    _sync(places)
    opened.rename(f"{folder}/waiting/{name}")
    _sync([f"{folder}/waiting", f"{folder}/open"] if sync else [])
    Path(f"{folder}/locks/{name}").unlink()
    os.close(lock)


def _sync(folders: Sequence[str]) -> None:
    for folder in folders:
        handle = os.open(folder, os.O_RDONLY)
        os.fsync(handle)
        os.close(handle)
