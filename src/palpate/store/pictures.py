"""Pictures as PNG files."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from palpate.store.errors import StoreError

__all__ = ["png"]


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
    StoreError
        If it has another shape or type.
    """
    kinds = {1: 0, 2: 4, 3: 2, 4: 6}
    samples = picture[..., np.newaxis] if picture.ndim == 2 else picture
    if samples.ndim != 3 or samples.shape[2] not in kinds or samples.dtype not in (np.uint8, np.uint16):
        found = f"an array of shape {picture.shape} and type {picture.dtype}"
        raise StoreError(f"{where}: {found}, expected a picture of uint8 or uint16, (rows, columns) or (.., 3)")
    rows, columns, depth = samples.shape
    if not samples.size:
        raise StoreError(f"{where}: a picture without a pixel, expected one at least")
    lines = np.ascontiguousarray(samples, dtype=samples.dtype.newbyteorder(">")).view(np.uint8).reshape(rows, -1)
    # each line begins with the number of its filter: none
    raw = np.pad(lines, ((0, 0), (1, 0))).tobytes()
    header = struct.pack(">IIBBBBB", columns, rows, samples.dtype.itemsize * 8, kinds[depth], 0, 0, 0)
    parts = (b"IHDR", header), (b"IDAT", zlib.compress(raw, 1)), (b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(kind, data) for kind, data in parts)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
