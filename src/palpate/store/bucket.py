"""Blobs in an S3-compatible store, by obstore."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from palpate.store.blobs import DAMAGED, verified
from palpate.store.content import file_digest
from palpate.store.errors import DamagedError

__all__ = ["BucketBlobs"]


class BucketBlobs:
    """Blobs in an S3-compatible store.

    Parameters
    ----------
    url
        Bucket and prefix, such as ``s3://lab/blobs``. Keys, region and endpoint come from the environment, as
        ``AWS_ACCESS_KEY_ID`` and the others of that family; any store that obstore knows will do.
    """

    def __init__(self, url: str) -> None:
        from obstore.store import from_url

        self.url = url
        self._store = from_url(url)

    def put(self, digest: str, data: bytes | Path) -> None:
        """Keep bytes under their digest; an object appears whole or not at all."""
        import obstore

        if self._there(digest):
            return
        # a file may have changed since its digest was taken
        if isinstance(data, Path) and file_digest(data) != digest:
            raise DamagedError(f"{data}: changed while it was read, expected a file that nothing writes to")
        obstore.put(self._store, _key(digest), data)

    def get(self, digest: str) -> bytes:
        """The bytes of a digest, verified."""
        import obstore

        try:
            data = bytes(obstore.get(self._store, _key(digest)).bytes())
        except FileNotFoundError:
            raise DamagedError(f"blob {digest}: is missing in {self.url}") from None
        return verified(digest, data, self.url)

    def all(self) -> Iterator[tuple[str, float]]:
        """Each digest with the time it was written [s since 1970]."""
        import obstore

        for page in obstore.list(self._store):
            for item in page:
                if not item["path"].endswith(DAMAGED):
                    yield item["path"].replace("/", ""), item["last_modified"].timestamp()

    def remove(self, digest: str) -> None:
        """Remove what nothing refers to."""
        import obstore

        obstore.delete(self._store, _key(digest))

    def set_aside(self, digest: str) -> None:
        """Rename damaged bytes."""
        import obstore

        if self._there(digest):
            obstore.rename(self._store, _key(digest), _key(digest) + DAMAGED)

    def _there(self, digest: str) -> bool:
        import obstore

        try:
            obstore.head(self._store, _key(digest))
        except FileNotFoundError:
            return False
        return True


def _key(digest: str) -> str:
    return f"{digest[:2]}/{digest[2:]}"
