"""Large bytes under their SHA-256: written once, verified when read; in a folder here, in S3 elsewhere."""

from __future__ import annotations

import errno
import math
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Protocol

from palpate.store.content import file_digest
from palpate.store.durable import make_folder, sync_folder
from palpate.store.errors import DamagedError, StoreError, UnavailableError, UnreadableError

__all__ = ["Blobs", "FolderBlobs", "is_digest"]

DRAFT = ".draft-"
PIECE_BYTES = 1 << 20
DAMAGED = ".damaged"
LEAVING = ".leaving"
SPOILT = (errno.EIO, errno.EISDIR, errno.ENOTDIR)
"""What is said of a file on a bad disk, and of one in whose place is something else."""
DIGEST = re.compile("[0-9a-f]{64}")


class Blobs(Protocol):
    """Where large bytes are kept. A digest is 64 hexadecimal digits."""

    def put(self, digest: str, data: bytes | Path) -> None:
        """Keep bytes, or those of a file, under their digest.

        Where they are there already they count as written now, so that nobody takes them for left over from long ago.

        Raises
        ------
        StoreError
            If a file cannot be read, or changes meanwhile.
        UnavailableError
            If they cannot be written.
        """

    def get(self, digest: str) -> bytes:
        """The bytes of a digest.

        Raises
        ------
        DamagedError
            If they are missing or others than were written.
        UnreadableError
            If these may not be read.
        """

    def size_bytes(self, digest: str) -> int:
        """How many bytes there are; raises as `get`, but of others than were written only where they are gone."""

    def pieces(self, digest: str, start: int, end: int) -> Iterator[bytes]:
        """The bytes from one place to another, piece by piece, so that few are in memory; they are not verified.

        Raises
        ------
        DamagedError
            If there are fewer.
        UnreadableError
            If these may not be read.
        """

    def all(self) -> Iterator[tuple[str, float]]:
        """Each digest with the time it was written [s since 1970]."""

    def remove(self, digest: str, written_before: float = math.inf) -> bool:
        """Remove what nothing refers to, if it was written before a time [s since 1970]; whether it was."""

    def set_aside(self, digest: str) -> None:
        """Move damaged bytes away, so that the right ones can be put in their place."""


class FolderBlobs:
    """Blobs in a folder, in subfolders by their first two digits.

    Parameters
    ----------
    folder
        Made on first use.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> digest = sha256(b"a picture").hexdigest()
    >>> with TemporaryDirectory() as folder:
    ...     blobs = FolderBlobs(Path(folder))
    ...     blobs.put(digest, b"a picture")
    ...     blobs.get(digest)
    b'a picture'
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._made = set[Path]()

    def put(self, digest: str, data: bytes | Path) -> None:
        """Keep bytes under their digest: written beside, flushed to the disk, renamed.

        Raises
        ------
        StoreError
            If a file to keep cannot be read.
        UnavailableError
            If the folder does not take it.
        """
        path = self._path(digest)
        try:
            if not _renewed(path):
                self._write(path, digest, data)
        except OSError as error:
            if isinstance(data, Path) and error.filename == str(data):
                raise StoreError(f"{data}: {error.strerror}, expected a file that can be read") from None
            raise UnavailableError(
                f"blobs {str(self.folder)!r}: {error.strerror}, expected a folder with space that can be written to"
            ) from None

    def _write(self, path: Path, digest: str, data: bytes | Path) -> None:
        if path.parent not in self._made:
            # once for each process: another one may have made it and not be done
            make_folder(path.parent)
            sync_folder(self.folder)
            sync_folder(self.folder.parent)
            self._made.add(path.parent)
        handle, name = tempfile.mkstemp(prefix=DRAFT, dir=path.parent)
        draft = Path(name)
        try:
            with os.fdopen(handle, "wb") as opened:
                for piece in _pieces(data):
                    opened.write(piece)
                opened.flush()
                os.fsync(opened.fileno())
            # a file may have changed since its digest was taken
            if isinstance(data, Path) and file_digest(draft) != digest:
                raise DamagedError(f"{data}: changed while it was read, expected a file that nothing writes to")
            draft.replace(path)
        finally:
            draft.unlink(missing_ok=True)
        sync_folder(path.parent)

    def get(self, digest: str) -> bytes:
        """The bytes of a digest, verified."""
        with self._told(digest):
            data = self._path(digest).read_bytes()
        return verified(digest, data, str(self.folder))

    def size_bytes(self, digest: str) -> int:
        """How many bytes there are."""
        with self._told(digest):
            return self._path(digest).stat().st_size

    def pieces(self, digest: str, start: int, end: int) -> Iterator[bytes]:
        """The bytes from one place to another, piece by piece; they are not verified.

        Raises
        ------
        DamagedError
            If there are fewer.
        """
        with self._told(digest), self._path(digest).open("rb") as opened:
            opened.seek(start)
            while start < end:
                piece = opened.read(min(PIECE_BYTES, end - start))
                if not piece:
                    raise cut_short(digest, end - start, str(self.folder))
                start += len(piece)
                yield piece

    @contextmanager
    def _told(self, digest: str) -> Iterator[None]:
        try:
            yield
        except FileNotFoundError:
            raise DamagedError(f"blob {digest}: is missing in {self.folder}") from None
        except OSError as error:
            told = f"blob {digest}: cannot be read in {self.folder} ({error.strerror})"
            if error.errno in SPOILT:
                raise DamagedError(f"{told}, expected what was written") from None
            raise UnreadableError(f"{told}, expected a file that can be read") from None

    def all(self) -> Iterator[tuple[str, float]]:
        """Each digest with the time it was written [s since 1970]; files with other names are not ours."""
        for path in sorted(self.folder.glob("??/*")):
            digest = path.parent.name + path.name
            # somebody may remove one while they are gone through, or have closed its folder
            with suppress(FileNotFoundError, PermissionError):
                if is_digest(digest):
                    yield digest, path.stat().st_mtime

    def remove(self, digest: str, written_before: float = math.inf) -> bool:
        """Remove what nothing refers to, if it is old enough.

        It is moved away first, and looked at then: who puts it meanwhile finds nothing and writes it again, and who
        put it before has made it young.
        """
        path = self._path(digest)
        leaving = path.with_name(path.name + LEAVING)
        try:
            path.replace(leaving)
        except FileNotFoundError:
            return False
        if leaving.stat().st_mtime >= written_before:
            leaving.replace(path)
            return False
        leaving.unlink()
        return True

    def set_aside(self, digest: str) -> None:
        """Rename damaged bytes."""
        path = self._path(digest)
        with suppress(FileNotFoundError):
            path.replace(path.with_name(path.name + DAMAGED))

    def _path(self, digest: str) -> Path:
        return self.folder / digest[:2] / digest[2:]


def is_digest(text: str) -> bool:
    """Whether a text is a SHA-256 as blobs are named by it: nothing else is listed, and so nothing else removed.

    Examples
    --------
    >>> is_digest("ab" * 32), is_digest("AB" * 32), is_digest("../" * 21 + "x")
    (True, False, False)
    """
    return DIGEST.fullmatch(text) is not None


def verified(digest: str, data: bytes, place: str) -> bytes:
    """The bytes, if they are the ones of the digest.

    Raises
    ------
    DamagedError
        If they are not.
    """
    if sha256(data).hexdigest() != digest:
        raise DamagedError(f"blob {digest}: {len(data)} bytes in {place} are not the ones that were written")
    return data


def cut_short(digest: str, missing: int, place: str) -> DamagedError:
    """The error of bytes that end before they should."""
    return DamagedError(f"blob {digest}: ends {missing} bytes early in {place}, expected what was written")


def _renewed(path: Path) -> bool:
    """Whether there is a file, which counts as written now then."""
    try:
        os.utime(path)
    except (FileNotFoundError, PermissionError, NotADirectoryError):
        # that of another user is replaced by the same bytes
        return False
    return True


def _pieces(data: bytes | Path) -> Iterator[bytes]:
    if isinstance(data, bytes):
        yield data
        return
    with data.open("rb") as opened:
        while piece := opened.read(PIECE_BYTES):
            yield piece
