"""Stores as earlier versions of the tables left them: rows that never change again, put in by plain SQL."""

import gzip
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, text

from palpate.store.blobs import Blobs

Row = dict[str, Any]
FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Filled:
    """What was in a store of a version.

    Attributes
    ----------
    version
        Of the tables.
    tables
        The rows of each, in an order in which they can be inserted.
    blobs
        Bytes by digest.
    digests
        Of the recordings, by id; what reading them must give.
    """

    version: str
    tables: dict[str, list[Row]]
    blobs: dict[str, bytes]
    digests: dict[str, str]

    def insert(self, connection: Connection, blobs: Blobs) -> None:
        """Put all of it into tables of its version."""
        for digest, data in self.blobs.items():
            blobs.put(digest, data)
        for table, rows in self.tables.items():
            for row in rows:
                names = ", ".join(row)
                values = ", ".join(f":{name}" for name in row)
                connection.execute(text(f"INSERT INTO {table} ({names}) VALUES ({values})"), row)
            if connection.dialect.name == "postgresql" and rows and "id" in rows[0]:
                last = f"SELECT setval(pg_get_serial_sequence('{table}', 'id'), max(id)) FROM {table}"
                connection.execute(text(last))


def rows_of(connection: Connection, table: str, columns: list[str]) -> list[Row]:
    """Some columns of a table as they are, in no order."""
    return [dict(row) for row in connection.execute(text(f"SELECT {', '.join(columns)} FROM {table}")).mappings()]


def write(filled: Filled) -> None:
    """Keep a store for the tests of later versions."""
    path = FOLDER / f"{filled.version}.json.gz"
    plain = vars(filled) | {"blobs": {digest: _plain(data) for digest, data in filled.blobs.items()}}
    plain["tables"] = {
        table: [{name: _plain(value) for name, value in row.items()} for row in rows]
        for table, rows in filled.tables.items()
    }
    path.write_bytes(gzip.compress(json.dumps(plain, indent=1).encode(), mtime=0))


def versions() -> list[str]:
    """Those of which there is a filled store, the oldest first."""
    return sorted(path.name.removesuffix(".json.gz") for path in FOLDER.glob("*.json.gz"))


@cache
def filled(version: str) -> Filled:
    """The store of a version."""
    plain = json.loads(gzip.decompress((FOLDER / f"{version}.json.gz").read_bytes()))
    tables = {
        table: [{name: _value(value) for name, value in row.items()} for row in rows]
        for table, rows in plain["tables"].items()
    }
    blobs = {digest: bytes.fromhex(data["hex"]) for digest, data in plain["blobs"].items()}
    return Filled(plain["version"], tables, blobs, plain["digests"])


def _plain(value: Any) -> Any:
    return {"hex": value.hex()} if isinstance(value, bytes) else value


def _value(plain: Any) -> Any:
    return bytes.fromhex(plain["hex"]) if isinstance(plain, dict) else plain
