"""Blobs in an S3-compatible store, by obstore."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.store.blobs import DAMAGED, verified
from palpate.store.content import file_digest
from palpate.store.errors import DamagedError, StoreError

if TYPE_CHECKING:
    from obstore.store import ClientConfig

__all__ = ["BucketBlobs"]


class BucketBlobs:
    """Blobs in an S3-compatible store.

    Parameters
    ----------
    url
        Bucket and prefix, such as ``s3://lab/blobs``. Keys, region and endpoint come from the environment, as
        ``AWS_ACCESS_KEY_ID`` and the others of that family; any store that obstore knows will do.

    Raises
    ------
    StoreError
        If it is no such address; later, from every method, if the store does not answer or does not let one in.
    """

    def __init__(self, url: str) -> None:
        try:
            from obstore.store import from_url
        except ImportError as error:
            raise StoreError(
                f'blobs {url!r}: need obstore, which is not installed: pip install "palpate[s3]"'
            ) from error
        self.url = url
        # an endpoint without TLS is what its address says, and must be said once more
        plain: ClientConfig = {"allow_http": os.environ.get("AWS_ENDPOINT_URL", "").startswith("http://")}
        with self._told():
            self._store = from_url(url, client_options=plain) if url.startswith("s3:") else from_url(url)

    def put(self, digest: str, data: bytes | Path) -> None:
        """Keep bytes under their digest; an object appears whole or not at all."""
        import obstore

        if self._there(digest):
            return
        # a file may have changed since its digest was taken
        if isinstance(data, Path) and file_digest(data) != digest:
            raise DamagedError(f"{data}: changed while it was read, expected a file that nothing writes to")
        try:
            with self._told():
                obstore.put(self._store, _key(digest), data)
        except FileNotFoundError:
            raise StoreError(
                f"blobs {self.url!r}: there is no such bucket, expected one that was made before"
            ) from None

    def get(self, digest: str) -> bytes:
        """The bytes of a digest, verified."""
        import obstore

        try:
            with self._told():
                data = bytes(obstore.get(self._store, _key(digest)).bytes())
        except FileNotFoundError:
            raise DamagedError(f"blob {digest}: is missing in {self.url}") from None
        return verified(digest, data, self.url)

    def all(self) -> Iterator[tuple[str, float]]:
        """Each digest with the time it was written [s since 1970]."""
        import obstore

        with self._told():
            for page in obstore.list(self._store):
                for item in page:
                    if not item["path"].endswith(DAMAGED):
                        yield item["path"].replace("/", ""), item["last_modified"].timestamp()

    def remove(self, digest: str) -> None:
        """Remove what nothing refers to."""
        import obstore

        with self._told():
            obstore.delete(self._store, _key(digest))

    def set_aside(self, digest: str) -> None:
        """Rename damaged bytes."""
        import obstore

        if self._there(digest):
            with self._told():
                obstore.rename(self._store, _key(digest), _key(digest) + DAMAGED)

    def _there(self, digest: str) -> bool:
        import obstore

        try:
            with self._told():
                obstore.head(self._store, _key(digest))
        except FileNotFoundError:
            return False
        return True

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Whatever goes wrong, but that something is not there, in one sentence."""
        from obstore.exceptions import BaseError

        try:
            yield
        except (BaseError, OSError, ValueError) as error:
            if isinstance(error, FileNotFoundError | StoreError):
                raise
            first = str(error).split("\n", maxsplit=1)[0].strip()
            expected = (
                "a bucket that answers and lets one in (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_ENDPOINT_URL)"
            )
            raise StoreError(f"blobs {self.url!r}: {first}; expected {expected}") from None


def _key(digest: str) -> str:
    return f"{digest[:2]}/{digest[2:]}"
