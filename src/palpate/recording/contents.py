"""Bytes of what a measurement wants to keep as a file: bytes, text, pictures, figures."""

from __future__ import annotations

import io
import json
import struct
import zlib
from pathlib import Path, PurePosixPath
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from palpate.recording.errors import RecordingError

__all__ = ["Content", "Figure", "content_of", "json_of", "png"]


@runtime_checkable
class Figure(Protocol):
    """A figure of matplotlib."""

    def savefig(self, file: io.BytesIO, /, *, format: str) -> None:
        """Draw it into a file."""


Content = bytes | str | Path | Figure | NDArray[np.uint8] | NDArray[np.uint16]


def content_of(name: str, content: Content) -> bytes | Path:
    """Return bytes to keep, or the path of a file to copy.

    Raises
    ------
    RecordingError
        If nothing is known to make of it.
    """
    ending = PurePosixPath(name).suffix.lower()
    if isinstance(content, Path):
        if not content.is_file():
            raise RecordingError(f"file {name!r}: there is no file {str(content)!r}, expected one to copy")
        return content
    if isinstance(content, str):
        return content.encode()
    if isinstance(content, bytes):
        return content
    if isinstance(content, np.ndarray):
        if ending != ".png":
            raise RecordingError(f"file {name!r}: an array was given, expected a name that ends in .png for a picture")
        return png(content, f"file {name!r}")
    if isinstance(content, Figure):
        drawn = io.BytesIO()
        content.savefig(drawn, format=ending.removeprefix(".") or "png")
        return drawn.getvalue()
    found = type(content).__name__
    raise RecordingError(f"file {name!r}: found {found}, expected bytes, text, a path, a picture or a figure")


def json_of(where: str, value: object) -> bytes:
    """Return a value as JSON; RecordingError where JSON cannot hold it."""
    plain = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    try:
        return json.dumps(plain, allow_nan=False, ensure_ascii=False).encode()
    except (TypeError, ValueError) as error:
        raise RecordingError(f"{where}: {error}, expected what JSON can hold") from error


def png(picture: NDArray[np.uint8] | NDArray[np.uint16], where: str) -> bytes:
    """Return a picture, without loss, as PNG.

    Parameters
    ----------
    picture
        8 or 16 bits a sample: (rows, columns) grey, or (rows, columns, k) with k = 1 grey, 2 grey and opacity,
        3 red green blue, 4 with opacity.
    where
        Begins the message of the error.

    Raises
    ------
    RecordingError
        If it has another shape or type.
    """
    kinds = {1: 0, 2: 4, 3: 2, 4: 6}
    samples = picture[..., np.newaxis] if picture.ndim == 2 else picture
    if samples.ndim != 3 or samples.shape[2] not in kinds or samples.dtype not in (np.uint8, np.uint16):
        found = f"an array of shape {picture.shape} and type {picture.dtype}"
        raise RecordingError(f"{where}: {found}, expected a picture of uint8 or uint16, (rows, columns) or (.., 3)")
    rows, columns, depth = samples.shape
    if not samples.size:
        raise RecordingError(f"{where}: a picture without a pixel, expected one at least")
    lines = np.ascontiguousarray(samples, dtype=samples.dtype.newbyteorder(">")).view(np.uint8).reshape(rows, -1)
    # each line begins with the number of its filter: none
    raw = np.pad(lines, ((0, 0), (1, 0))).tobytes()
    header = struct.pack(">IIBBBBB", columns, rows, samples.dtype.itemsize * 8, kinds[depth], 0, 0, 0)
    parts = (b"IHDR", header), (b"IDAT", zlib.compress(raw, 1)), (b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in parts)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
