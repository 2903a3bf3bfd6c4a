"""Bytes that somebody else has uploaded, so that no browser takes them for a page of this site.

Pictures and sounds that begin as such are shown; all else, and what only says that it is a picture, is a download of
no particular type. Nothing of it may run: not here, and not when opened by itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from urllib.parse import quote

from fastapi import Request
from fastapi.responses import Response

from palpate.server.problems import problem

__all__ = ["download", "safe_type"]

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
NO_TYPE = "application/octet-stream"


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


def download(request: Request, data: bytes, name: str, stated: str, digest: str) -> Response:
    """Bytes, or the part of them that a header ``Range`` asks for."""
    kind = safe_type(stated, data)
    shown = "inline" if kind != NO_TYPE else "attachment"
    headers = {
        "Content-Disposition": f"{shown}; filename*=UTF-8''{quote(_plain_name(name), safe='')}",
        "Content-Security-Policy": "default-src 'none'; sandbox",
        "Accept-Ranges": "bytes",
        "ETag": f'"{digest}"',
        # what is under a digest never changes, but who may see it can
        "Cache-Control": "private, no-cache",
    }
    if request.headers.get("if-none-match") == headers["ETag"]:
        return Response(None, 304, headers)
    asked = _range(request.headers.get("range"), len(data))
    if asked is None:
        return Response(data, 200, headers, kind)
    start, end = asked
    return Response(data[start:end], 206, {**headers, "Content-Range": f"bytes {start}-{end - 1}/{len(data)}"}, kind)


def _plain_name(name: str) -> str:
    """The last part of a name, as programs propose it as a file's."""
    return name.replace("\\", "/").rsplit("/", 1)[-1] or "file"


def _range(header: str | None, size: int) -> tuple[int, int] | None:
    """Where one range begins and ends; None where all is asked for, or several parts, which are answered by all."""
    if header is None or not header.startswith("bytes=") or "," in header:
        return None
    first, dash, last = header.removeprefix("bytes=").strip().partition("-")
    if not dash or not all(part.isascii() and (part.isdigit() or not part) for part in (first, last)):
        return None
    if len(first) > 18 or len(last) > 18 or not first + last:
        return None
    start = int(first) if first else max(0, size - int(last))
    end = min(size, int(last) + 1) if first and last else size
    if start >= end:
        raise problem(
            416, f"range: {header!r} is outside of {size} bytes", headers={"Content-Range": f"bytes */{size}"}
        )
    return start, end
