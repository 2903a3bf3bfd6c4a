"""Bytes in the blobs that may be too many for memory: read in pieces, verified as far as that can be done."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256

from palpate.store.blobs import PIECE_BYTES, Blobs
from palpate.store.errors import DamagedError

__all__ = ["StoredBytes"]


class StoredBytes:
    """What is under a digest.

    What fits into one piece is read and verified at once. Of what is larger, all of it is verified while it is read,
    so that the last piece comes only where it is what was written; a part of it cannot be.

    Parameters
    ----------
    blobs
        Where they are.
    digest
        Their SHA-256.

    Raises
    ------
    DamagedError
        If they are missing, or others than were written as far as that is seen by now.

    Examples
    --------
    >>> from pathlib import Path
    >>> from palpate.store.blobs import FolderBlobs
    >>> from tempfile import TemporaryDirectory
    >>> digest = sha256(b"a picture").hexdigest()
    >>> with TemporaryDirectory() as folder:
    ...     blobs = FolderBlobs(Path(folder))
    ...     blobs.put(digest, b"a picture")
    ...     found = StoredBytes(blobs, digest)
    >>> found.size, found.beginning(1), b"".join(found.pieces(2, 9))
    (9, b'a', b'picture')
    """

    def __init__(self, blobs: Blobs, digest: str) -> None:
        self.digest = digest
        self.size = blobs.size_bytes(digest)
        self._blobs = blobs
        self._small = blobs.get(digest) if self.size <= PIECE_BYTES else None

    def beginning(self, count: int) -> bytes:
        """The first bytes."""
        if self._small is not None:
            return self._small[:count]
        return b"".join(self._blobs.pieces(self.digest, 0, min(count, self.size)))

    def pieces(self, start: int, end: int) -> Iterator[bytes]:
        """The bytes from one place to another; of all of them, the last piece only where they are what was written."""
        if self._small is not None:
            return iter((self._small[start:end],))
        found = self._blobs.pieces(self.digest, start, end)
        return self._verified(found) if (start, end) == (0, self.size) else found

    def _verified(self, pieces: Iterator[bytes]) -> Iterator[bytes]:
        hashed, held = sha256(), b""
        for piece in pieces:
            hashed.update(piece)
            if held:
                yield held
            held = piece
        if hashed.hexdigest() != self.digest:
            raise DamagedError(f"blob {self.digest}: {self.size} bytes are not the ones that were written")
        yield held
