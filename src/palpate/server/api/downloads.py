"""Bytes that somebody else has uploaded, so that no browser takes them for a page of this site.

Pictures and sounds that begin as such are shown; all else, and what only says that it is a picture, is a download of
no particular type. Nothing of it may run: not here, and not when opened by itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol
from urllib.parse import quote

from fastapi import Request
from fastapi.responses import Response, StreamingResponse

from palpate.server.api.ranges import is_known, wanted_range
from palpate.server.heads import is_head
from palpate.server.state import state_of
from palpate.store.bucket import BucketBlobs
from palpate.store.stored_bytes import StoredBytes

__all__ = ["BEGINNING_BYTES", "NO_TYPE", "download", "safe_type", "stored_download"]

SHOWN: Mapping[str, tuple[tuple[int, bytes], ...]] = {
    "image/png": ((0, b"\x89PNG\r\n\x1a\n"),),
    "image/jpeg": ((0, b"\xff\xd8\xff"),),
    "image/gif": ((0, b"GIF8"),),
    "image/webp": ((0, b"RIFF"), (8, b"WEBP")),
    "audio/wav": ((0, b"RIFF"), (8, b"WAVE")),
    "audio/ogg": ((0, b"OggS"),),
    "audio/flac": ((0, b"fLaC"),),
}
"""What may be shown, and how it begins."""
SAME = {"image/jpg": "image/jpeg", "audio/x-wav": "audio/wav", "audio/wave": "audio/wav", "audio/vnd.wave": "audio/wav"}
LONGEST_NAME, LONGEST_ENDING = 60, 12
"""Letters; one may take four bytes, and each of them three in a header."""
NO_TYPE = "application/octet-stream"
BEGINNING_BYTES = 16
SIGNED_FOR_S = 60
"""How long an address in the bucket may be used; what has begun goes on."""


class Content(Protocol):
    """Bytes that can be read in part."""

    @property
    def size(self) -> int:
        """How many there are."""

    def beginning(self, count: int) -> bytes:
        """The first ones."""

    def pieces(self, start: int, end: int) -> Iterator[bytes]:
        """Those from one place to another."""


def safe_type(stated: str, data: bytes) -> str:
    r"""The type to say: the stated one where it may be shown and the bytes begin so.

    Examples
    --------
    >>> safe_type("image/png", b"<html>"), safe_type("image/jpg", b"\xff\xd8\xff\xe0")
    ('application/octet-stream', 'image/jpeg')
    """
    kind = SAME.get(stated.lower(), stated.lower())
    begins = SHOWN.get(kind)
    fits = begins is not None and all(data[at : at + len(mark)] == mark for at, mark in begins)
    return kind if fits else NO_TYPE


def stored_download(request: Request, name: str, stated: str, digest: str) -> Response:
    """What is in the blobs, or a part of it; where the server may, the address in the bucket at which it is."""
    state = state_of(request)
    blobs = state.store.blobs
    content = StoredBytes(blobs, digest)
    # a page may show pictures and sounds of this site only
    is_shown = safe_type(stated, content.beginning(BEGINNING_BYTES)) != NO_TYPE
    # an address that is signed for GET answers nothing else
    if is_shown or is_head(request) or not (state.settings.signed_urls and isinstance(blobs, BucketBlobs)):
        return download(request, content, name, stated, digest)
    url = blobs.signed_url(digest, SIGNED_FOR_S, NO_TYPE, _disposition("attachment", name))
    return Response(None, 307, {"Location": url, "Cache-Control": "no-store"})


def download(request: Request, content: Content, name: str, stated: str, digest: str) -> Response:
    """All of something, or the part of it that a header ``Range`` asks for."""
    kind, size = safe_type(stated, content.beginning(BEGINNING_BYTES)), content.size
    headers = {
        "Content-Disposition": _disposition("inline" if kind != NO_TYPE else "attachment", name),
        "Content-Security-Policy": "default-src 'none'; sandbox",
        "Accept-Ranges": "bytes",
        "ETag": f'"{digest}"',
        # what is under a digest never changes, but who may see it can
        "Cache-Control": "private, no-cache",
    }
    if is_known(request.headers, headers["ETag"]):
        return Response(None, 304, headers)
    asked = wanted_range(request.headers, headers["ETag"], size)
    start, end = asked or (0, size)
    headers["Content-Length"] = str(end - start)
    if asked is not None:
        headers["Content-Range"] = f"bytes {start}-{end - 1}/{size}"
    status = 200 if asked is None else 206
    if is_head(request):
        return Response(None, status, headers, kind)
    return StreamingResponse(content.pieces(start, end), status, headers, kind)


def _disposition(shown: str, name: str) -> str:
    return f"{shown}; filename*=UTF-8''{quote(_plain_name(name), safe='')}"


def _plain_name(name: str) -> str:
    """The last part of a name, as programs propose it as a file's.

    Without what is not printed, as a letter that turns the direction of writing shows an ending that is none; and not
    longer than a file's name may be.
    """
    last = "".join(letter for letter in name.replace("\\", "/").rsplit("/", 1)[-1] if letter.isprintable())
    stem, dot, ending = last.rpartition(".")
    if dot and len(ending) < LONGEST_ENDING:
        last = f"{stem[: LONGEST_NAME - len(ending)]}.{ending}"
    return last[: LONGEST_NAME + 1].lstrip(".") or "file"
