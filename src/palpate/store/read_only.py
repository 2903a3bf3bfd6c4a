"""SQLite files that may be read and not written, as those on a read-only disk."""

from __future__ import annotations

import os
from pathlib import Path

from palpate.store.errors import StoreError

__all__ = ["read_only_uri"]


def read_only_uri(path: Path) -> str | None:
    """The URI by which SQLite reads a file that cannot be written; None where it can be, or is not there.

    Raises
    ------
    StoreError
        If a part of it stands in a log that only somebody who may write can work into it.

    Examples
    --------
    >>> read_only_uri(Path("new.sqlite")) is None
    True
    """
    # SQLite makes files beside it even to read
    folder_is_open = os.access(path.parent, os.W_OK)
    if not path.exists() or (folder_is_open and os.access(path, os.W_OK)):
        return None
    log, index = (path.with_name(path.name + ending) for ending in ("-wal", "-shm"))
    uri = f"{path.absolute().as_uri()}?mode=ro"
    # with an index somebody who may write has it open, and it is read as usual
    if index.exists():
        return uri
    if log.exists() and log.stat().st_size:
        if folder_is_open:
            return uri
        raise StoreError(
            f"store {str(path)!r}: {log.name} has to be worked into it, and the folder cannot be written; "
            "expected a copy of both in a folder that can"
        )
    # else a log and an index would be left, which those who may write the file might not be able to write
    return f"{uri}&immutable=1"
