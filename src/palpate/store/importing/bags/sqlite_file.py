"""The SQLite files of ROS 2 bags."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from pathlib import Path

from palpate.store.errors import StoreError
from palpate.store.importing.bags.packets import LATEST_NS, Kind, Packet, translated
from palpate.store.importing.bags.unpacking import unzstd

__all__ = ["SqliteFile"]

DEFINITIONS = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
MESSAGES = "SELECT timestamp, data FROM messages WHERE topic_id = ? ORDER BY id"


class SqliteFile:
    """A source of the messages of a ``.db3`` file, topic by topic; for parameters and attributes see `McapFile`."""

    def __init__(self, path: Path, *, is_packed: bool = False) -> None:
        self.path, self.is_packed = path, is_packed
        self.topics: set[str] = set()
        self.first_ns: int | None = None
        self.notices: list[str] = []

    def packets(self, wanted: Collection[str]) -> Iterator[Packet]:
        """Read the messages of the topics that are wanted, in the order in which each topic's were written."""
        with translated(self.path.name, "the SQLite file of a ROS 2 bag"):
            try:
                with closing(self._connect()) as connection:
                    yield from self._packets(connection, wanted)
            except sqlite3.Error as error:
                raise StoreError(f"{self.path.name}: {error}, expected the SQLite file of a ROS 2 bag") from error

    def _connect(self) -> sqlite3.Connection:
        # what was not written to the end stands beside the file, and only a database that may change is mended by it
        beside = any(self.path.with_name(self.path.name + end).exists() for end in ("-wal", "-journal"))
        how = "mode=ro" if beside else "mode=ro&immutable=1"
        return sqlite3.connect(f"{self.path.resolve().as_uri()}?{how}", uri=True)

    def _packets(self, connection: sqlite3.Connection, wanted: Collection[str]) -> Iterator[Packet]:
        # a view may have rows without end
        connection.execute("PRAGMA trusted_schema = OFF")
        tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not {"topics", "messages"} <= tables:
            raise StoreError(f"{self.path.name}: has no tables topics and messages, expected those of a ROS 2 bag")
        rows = connection.execute(DEFINITIONS).fetchall() if "message_definitions" in tables else []
        definitions = {type: (language, text) for type, language, text in rows}
        (self.first_ns,) = connection.execute("SELECT MIN(timestamp) FROM messages").fetchone()
        topics = connection.execute("SELECT id, name, type, serialization_format FROM topics ORDER BY id").fetchall()
        self.topics |= {name for _, name, _, _ in topics}
        for id, name, type, encoding in topics:
            if name in wanted:
                kind = Kind(name, type, encoding, *definitions.get(type, ("", "")))
                for log_ns, data in connection.execute(MESSAGES, (id,)):
                    yield self._packet(kind, log_ns, data)

    def _packet(self, kind: Kind, log_ns: object, data: object) -> Packet:
        if not isinstance(log_ns, int) or not isinstance(data, bytes) or not 0 <= log_ns <= LATEST_NS:
            found = f"a message of {kind.topic} at {log_ns!r} with {type(data).__name__}"
            raise StoreError(f"{self.path.name}: {found}, expected ns since 1970 and bytes")
        return Packet(kind, log_ns, unzstd(data, self.path.name) if self.is_packed else data)
