"""SQLite files of other programs, which are looked at without being changed."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

from palpate.store.read_only import read_only_uri

__all__ = ["is_foreign"]

OURS = {"alembic_version", "recordings"}
"""Tables that a store has, whole or damaged."""
WAIT_S = 30


def is_foreign(path: Path) -> bool:
    """Whether a file is a database with tables, and none of them those of a store.

    What cannot be read here is not foreign: whoever opens the store is told what is wrong with it.

    Raises
    ------
    StoreError
        As `read_only_uri`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "visits.sqlite")
    ...     with closing(sqlite3.connect(path)) as connection:
    ...         _ = connection.execute("CREATE TABLE visits (id)")
    ...     is_foreign(path)
    True
    """
    if not path.is_file():
        return False
    # where nothing may be written, SQLite would leave a log and an index beside it
    uri = read_only_uri(path) or f"{path.absolute().as_uri()}?mode=ro"
    try:
        with closing(sqlite3.connect(uri, uri=True, timeout=WAIT_S)) as connection:
            rows = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
    except (sqlite3.DatabaseError, UnicodeDecodeError):
        return False
    return bool(rows) and OURS.isdisjoint(name for (name,) in rows)
