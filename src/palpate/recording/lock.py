"""Locks that end with the process that holds them, however it ends."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

__all__ = ["Lock", "locked"]


class Lock:
    """A file that one holder at a time has locked, in this process or another.

    Parameters
    ----------
    path
        The file, which is there only while someone holds the lock or has been killed holding it.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     first, second = Lock(Path(folder) / "lock"), Lock(Path(folder) / "lock")
    ...     first.take(), second.take(), first.leave(), second.take(), second.leave()
    (True, False, None, True, None)
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._handle: int | None = None

    def take(self) -> bool:
        """Take the lock and tell whether that went well; it never waits."""
        handle = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o666)
        if not (_lock(handle) and self._is_there(handle)):
            os.close(handle)
            return False
        self._handle = handle
        return True

    def leave(self) -> None:
        """Let the lock go."""
        if self._handle is None:
            return
        # while it is held nobody else removes it; Windows removes nothing that is open
        with suppress(FileNotFoundError, PermissionError):
            self._path.unlink()
        os.close(self._handle)
        self._handle = None

    def _is_there(self, handle: int) -> bool:
        """Whether the locked file is still the one of this name: its last holder may have removed it."""
        with suppress(FileNotFoundError):
            return os.path.samestat(os.fstat(handle), self._path.stat())
        return False


@contextmanager
def locked(path: Path) -> Iterator[bool]:
    """Hold a lock for as long as the block runs; what it gives tells whether the lock was free."""
    lock = Lock(path)
    taken = lock.take()
    try:
        yield taken
    finally:
        lock.leave()


if sys.platform == "win32":
    import msvcrt

    def _lock(handle: int) -> bool:
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

else:
    import fcntl

    def _lock(handle: int) -> bool:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
