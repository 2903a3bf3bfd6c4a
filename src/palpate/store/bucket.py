"""Blobs in an S3-compatible store, by obstore."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.errors import extra
from palpate.store.blobs import DAMAGED, PIECE_BYTES, cut_short, is_digest, verified
from palpate.store.bucket_errors import NotThereError, told
from palpate.store.content import file_digest
from palpate.store.errors import DamagedError, StoreError
from palpate.store.signing import signed_again

if TYPE_CHECKING:
    from obstore.store import ClientConfig

__all__ = ["BucketBlobs"]

RENEWED_S = 12 * 3600.0
SECRET = "AWS_SECRET_ACCESS_KEY"
ENDPOINTS = ("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL", "AWS_ENDPOINT")


class BucketBlobs:
    """Blobs in an S3-compatible store.

    Parameters
    ----------
    url
        Bucket and prefix, such as ``s3://lab/blobs``. Keys, region and endpoint come from the environment, as
        ``AWS_ACCESS_KEY_ID`` and the others of that family; any store that obstore knows will do.

    Raises
    ------
    UnavailableError
        If it is no such address; later, from every method, if the store does not answer or does not let one in.
    """

    def __init__(self, url: str) -> None:
        try:
            from obstore.store import from_url
        except ImportError as error:
            raise StoreError(f"blobs {url!r}: need obstore, which is not installed: {extra('s3')}") from error
        self.url = url
        with told(url):
            self._store = from_url(url, client_options=_options()) if url.startswith("s3:") else from_url(url)

    def put(self, digest: str, data: bytes | Path) -> None:
        """Keep bytes under their digest; an object appears whole or not at all.

        Raises
        ------
        DamagedError
            If a file to keep has changed since its digest was taken.
        """
        import obstore

        # what is older is put again, so that nobody takes it for left over
        written = self._written(digest)
        if written is not None and written > time.time() - RENEWED_S:
            return
        # a file may have changed since its digest was taken
        if isinstance(data, Path) and file_digest(data) != digest:
            raise DamagedError(f"{data}: changed while it was read, expected a file that nothing writes to")
        with told(self.url):
            obstore.put(self._store, _key(digest), data)

    def get(self, digest: str) -> bytes:
        """The bytes of a digest, verified."""
        import obstore

        with self._told(digest):
            data = bytes(obstore.get(self._store, _key(digest)).bytes())
        return verified(digest, data, self.url)

    def size_bytes(self, digest: str) -> int:
        """How many bytes there are."""
        import obstore

        with self._told(digest):
            return obstore.head(self._store, _key(digest))["size"]

    def pieces(self, digest: str, start: int, end: int) -> Iterator[bytes]:
        """The bytes from one place to another, piece by piece; they are not verified.

        Raises
        ------
        DamagedError
            If there are fewer.
        """
        import obstore

        if start >= end:
            return
        with self._told(digest):
            found = obstore.get(self._store, _key(digest), options={"range": (start, end)})
            for piece in found.stream(min_chunk_size=PIECE_BYTES):
                start += len(piece)
                yield bytes(piece)
        if start < end:
            raise cut_short(digest, end - start, self.url)

    def all(self) -> Iterator[tuple[str, float]]:
        """Each digest with the time it was written [s since 1970]; objects with other names are not ours."""
        import obstore

        with told(self.url):
            for page in obstore.list(self._store):
                for item in page:
                    digest = item["path"].replace("/", "", 1)
                    if is_digest(digest) and _key(digest) == item["path"]:
                        yield digest, item["last_modified"].timestamp()

    def remove(self, digest: str, written_before: float = math.inf) -> bool:
        """Remove what nothing refers to, if it is old enough."""
        import obstore

        if written_before < math.inf:
            written = self._written(digest)
            if written is None or written >= written_before:
                return False
        with told(self.url):
            obstore.delete(self._store, _key(digest))
        return True

    def set_aside(self, digest: str) -> None:
        """Rename damaged bytes."""
        import obstore

        if self._written(digest) is not None:
            with told(self.url):
                obstore.rename(self._store, _key(digest), _key(digest) + DAMAGED)

    def signed_url(self, digest: str, seconds: float, media_type: str, disposition: str) -> str:
        """An address at which anybody gets the bytes for a while, with these headers and no others.

        Raises
        ------
        StoreError
            If there are no keys in the environment to sign with.
        """
        import obstore
        from obstore.store import S3Store

        secret = os.environ.get(SECRET)
        if not isinstance(self._store, S3Store) or not secret:
            raise StoreError(f"blobs {self.url!r}: cannot be signed for, expected a bucket of S3 and {SECRET}")
        with told(self.url):
            url = obstore.sign(self._store, "GET", _key(digest), timedelta(seconds=seconds))
        more = {"response-content-type": media_type, "response-content-disposition": disposition}
        return signed_again(url, more, secret)

    @contextmanager
    def _told(self, digest: str) -> Iterator[None]:
        try:
            with told(self.url):
                yield
        except NotThereError:
            raise DamagedError(f"blob {digest}: is missing in {self.url}") from None

    def _written(self, digest: str) -> float | None:
        """When it was written [s since 1970]; None where it is not there."""
        import obstore

        try:
            with told(self.url):
                return obstore.head(self._store, _key(digest))["last_modified"].timestamp()
        except NotThereError:
            return None


def _key(digest: str) -> str:
    return f"{digest[:2]}/{digest[2:]}"


def _options() -> ClientConfig:
    """An endpoint without TLS is what its address says, and must be said once more."""
    endpoints = (os.environ.get(name, "") for name in ENDPOINTS)
    return {"allow_http": any(endpoint.startswith("http://") for endpoint in endpoints)}
