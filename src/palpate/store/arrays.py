"""Arrays as bytes: each one byte-shuffled, all of a series compressed together by zstd.

Shuffling puts the first bytes of all numbers before the second ones: numbers of a signal differ in their last bytes
only, so that the others compress well.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import zstandard
from numpy.typing import NDArray

from palpate.store.content import channel_arrays
from palpate.store.errors import DamagedError
from palpate.store.records import Channel, Series

__all__ = ["pack_bytes", "pack_series", "unpack_bytes", "unpack_series"]

LEVEL = 1
LARGEST = 1 << 34
COUNT = np.dtype("<u4")
TIME = np.dtype("<f8")
# a compression context that two threads use at once writes rubbish
contexts = threading.local()


def pack_bytes(data: bytes) -> bytes:
    """Compress bytes, with a checksum inside.

    Examples
    --------
    >>> unpack_bytes(pack_bytes(b"mug" * 9)) == b"mug" * 9
    True
    """
    try:
        compressor: zstandard.ZstdCompressor = contexts.compressor
    except AttributeError:
        compressor = contexts.compressor = zstandard.ZstdCompressor(level=LEVEL, write_checksum=True)
    return compressor.compress(data)


def unpack_bytes(data: bytes) -> bytes:
    """Undo `pack_bytes`.

    Raises
    ------
    DamagedError
        If they are not the bytes that were written.
    """
    try:
        decompressor: zstandard.ZstdDecompressor = contexts.decompressor
    except AttributeError:
        decompressor = contexts.decompressor = zstandard.ZstdDecompressor()
    try:
        return decompressor.decompress(data, max_output_size=0, allow_extra_data=False)
    except (zstandard.ZstdError, MemoryError):
        raise DamagedError("compressed bytes cannot be read, expected those that were written") from None


def pack_series(series: Series) -> bytes:
    """All samples and time stamps of a series, compressed.

    The layout, without which they cannot be read, is `palpate.store.content.layout_plain`.
    """
    counts = np.array([len(channel.values) for channel in series.channels], dtype=COUNT)
    parts = [counts.tobytes()]
    parts += [_shuffle(array) for channel in series.channels for array in channel_arrays(channel)]
    return pack_bytes(b"".join(parts))


def unpack_series(name: str, layout: Sequence[Mapping[str, Any]], data: bytes) -> Series:
    """Undo `pack_series`.

    Raises
    ------
    DamagedError
        If they are not the bytes that were written.
    """
    raw = unpack_bytes(data)
    counts = np.frombuffer(raw, COUNT, len(layout)) if len(raw) >= COUNT.itemsize * len(layout) else ()
    cut = COUNT.itemsize * len(layout)
    channels = []
    for channel, count in zip(layout, counts, strict=False):
        values, cut = _unshuffle(raw, cut, np.dtype(channel["dtype"]), (int(count), *channel["shape"]))
        time_s = None
        if channel["timed"]:
            time_s, cut = _unshuffle(raw, cut, TIME, (int(count),))
        channels.append(
            Channel(channel["name"], channel["quantity"], channel["unit"], values, channel["rate_hz"], time_s)
        )
    if cut != len(raw) or len(channels) != len(layout):
        raise DamagedError(f"series {name!r}: {len(raw)} bytes, expected {cut} as its layout says")
    return Series(name, tuple(channels))


def _shuffle(array: NDArray[Any]) -> bytes:
    # one column: an array without samples has bytes to none of its numbers, and reshape(-1, n) could not tell
    return array.reshape(array.size, 1).view(np.uint8).T.tobytes()


def _unshuffle(raw: bytes, start: int, dtype: np.dtype[Any], shape: tuple[int, ...]) -> tuple[NDArray[Any], int]:
    """The array that begins at `start`, and where it ends."""
    size = 1
    for length in shape:
        size *= length
    end = start + size * dtype.itemsize
    if end > len(raw):
        raise DamagedError(f"a series has {len(raw)} bytes, expected {end} or more as its layout says")
    planes = np.frombuffer(raw, np.uint8, size * dtype.itemsize, start).reshape(dtype.itemsize, size)
    return np.ascontiguousarray(planes.T).view(dtype).reshape(shape), end
