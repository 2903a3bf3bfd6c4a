"""Images of messages as files: compressed ones as they are, others as PNG."""

from __future__ import annotations

import base64
import binascii
import io
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import choices
from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, member
from palpate.store.pictures import png

__all__ = ["bytes_in", "image_file"]

ENCODINGS: Mapping[str, tuple[str, int]] = {
    "mono8": ("u1", 1),
    "mono16": ("u2", 1),
    "rgb8": ("u1", 3),
    "bgr8": ("u1", 3),
    "rgba8": ("u1", 4),
    "bgra8": ("u1", 4),
    "rgb16": ("u2", 3),
    "bgr16": ("u2", 3),
    "8UC1": ("u1", 1),
    "8UC3": ("u1", 3),
    "16UC1": ("u2", 1),
    "32FC1": ("f4", 1),
}
"""Encoding to the type of a sample and how many a pixel has."""

BEGINNINGS: Mapping[bytes, str] = {
    b"\x89PNG": ".png",
    b"\xff\xd8\xff": ".jpg",
    b"II*\0": ".tiff",
    b"MM\0*": ".tiff",
    b"RIFF": ".webp",
}


def image_file(message: Any, where: str) -> tuple[str, bytes]:
    """The ending and the bytes of the file that an image becomes.

    An image of floating-point numbers, as of depth in metres, becomes an array for numpy, as PNG cannot hold it.

    Raises
    ------
    StoreError
        If it is encoded in a way that is not supported, or has less data than pixels.
    """
    if member(message, "encoding") is MISSING:
        return _compressed(message, where)
    picture = _pixels(message, where)
    if picture.dtype.kind != "f":
        return ".png", png(picture, where)
    file = io.BytesIO()
    np.save(file, picture, allow_pickle=False)
    return ".npy", file.getvalue()


def bytes_in(value: Any, where: str) -> bytes:
    """Bytes of a message: an array of them, or as JSON holds them, a list or base64."""
    try:
        if isinstance(value, str):
            return base64.b64decode(value, validate=True)
        if isinstance(value, np.ndarray):
            return value.astype(np.uint8, casting="safe", copy=False).tobytes()
        return bytes(value) if isinstance(value, list | bytes) else b""
    except (binascii.Error, TypeError, ValueError) as error:
        raise StoreError(f"{where}: {error}, expected bytes") from error


def _compressed(message: Any, where: str) -> tuple[str, bytes]:
    data = bytes_in(member(message, "data"), f"{where}.data")
    if not data:
        raise StoreError(f"{where}: holds no image, expected a message such as sensor_msgs/Image or CompressedImage")
    ending = next((ending for start, ending in BEGINNINGS.items() if data.startswith(start)), None)
    if ending is None:
        raise StoreError(
            f"{where}: format {member(message, 'format')!r} is not known, expected PNG, JPEG, TIFF or WebP"
        )
    return ending, data


def _pixels(message: Any, where: str) -> NDArray[Any]:
    encoding = member(message, "encoding")
    if encoding not in ENCODINGS:
        raise StoreError(f"{where}: encoding {encoding!r} is not supported; {choices(ENCODINGS)}")
    code, depth = ENCODINGS[encoding]
    rows, columns, step = (member(message, name) for name in ("height", "width", "step"))
    data = bytes_in(member(message, "data"), f"{where}.data")
    dtype = np.dtype(code).newbyteorder(">" if member(message, "is_bigendian") else "<")
    line = int(columns) * depth * dtype.itemsize
    if step < line or len(data) < step * (rows - 1) + line or rows < 1 or columns < 1:
        found = f"{len(data)} bytes for {rows} rows of {step} bytes and {columns} columns of {encoding}"
        raise StoreError(f"{where}: {found}, expected at least one pixel and as many bytes as they need")
    # rows may be padded, and the last one need not be
    padded = np.zeros(rows * step, np.uint8)
    padded[: len(data)] = np.frombuffer(data, np.uint8)[: rows * step]
    lines = np.ascontiguousarray(padded.reshape(rows, step)[:, :line])
    picture = lines.view(dtype).reshape(rows, columns, depth).astype(dtype.newbyteorder("="))
    if encoding.startswith("bgr"):
        picture = picture[..., [2, 1, 0, 3][:depth]]
    return picture[..., 0] if depth == 1 else picture
