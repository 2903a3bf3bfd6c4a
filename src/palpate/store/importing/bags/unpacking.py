"""Decompression with a limit, as a few bytes may stand for more than a computer holds."""

from __future__ import annotations

import bz2
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Protocol

import zstandard

from palpate.store.errors import StoreError

__all__ = ["LARGEST_BYTES", "LARGEST_FILE_BYTES", "unbz2", "unlz4", "unzstd", "unzstd_file"]

LARGEST_BYTES = 256 << 20
"""What a piece of a bag may hold at most when it is unpacked: a message, or a chunk of them."""

LARGEST_FILE_BYTES = 16 << 30
"""What a file of a bag may hold at most when it is unpacked."""

PIECE_BYTES = 1 << 10
"""A piece of zstd of this size holds 32 MiB at most."""


class Unpacker(Protocol):
    """What lz4 and bz2 have in common."""

    @property
    def eof(self) -> bool:
        """Whether all is unpacked."""

    def decompress(self, data: bytes, max_length: int = -1) -> bytes:
        """Unpack at most so much."""


def unzstd(data: bytes, where: str, largest: int = LARGEST_BYTES) -> bytes:
    """Undo zstd; StoreError if it is damaged or holds too much."""
    pieces = (data[start : start + PIECE_BYTES] for start in range(0, len(data), PIECE_BYTES))
    return b"".join(_unzstd(pieces, where, largest))


def unzstd_file(packed: Path, unpacked: Path, largest: int = LARGEST_FILE_BYTES) -> None:
    """Undo zstd of a file into another; StoreError if it is damaged or holds too much."""
    with packed.open("rb") as source, unpacked.open("xb") as target:
        for piece in _unzstd(iter(partial(source.read, PIECE_BYTES), b""), packed.name, largest):
            target.write(piece)


def _unzstd(pieces: Iterable[bytes], where: str, largest: int) -> Iterator[bytes]:
    """What small pieces hold, one frame or several; one that ends too early is not taken for whole."""
    size, is_whole, frame = 0, False, zstandard.ZstdDecompressor().decompressobj()
    for given in pieces:
        piece = given
        while piece:
            try:
                found = frame.decompress(piece)
            except (zstandard.ZstdError, MemoryError) as error:
                raise _damaged(where, "zstd", error) from error
            size += len(found)
            _check_size(size, where, largest)
            yield found
            is_whole, piece = frame.eof, frame.unused_data if frame.eof else b""
            if is_whole:
                frame = zstandard.ZstdDecompressor().decompressobj()
    if not is_whole:
        raise _damaged(where, "zstd", "it ends too early")


def unlz4(data: bytes, where: str, largest: int = LARGEST_BYTES) -> bytes:
    """Undo lz4 as `unzstd` does zstd."""
    import lz4.frame  # type: ignore[import-untyped]

    return _unpacked(lz4.frame.LZ4FrameDecompressor(), data, where, largest)


def unbz2(data: bytes, where: str, largest: int = LARGEST_BYTES) -> bytes:
    """Undo bz2 as `unzstd` does zstd."""
    return _unpacked(bz2.BZ2Decompressor(), data, where, largest)


def _unpacked(unpacker: Unpacker, data: bytes, where: str, largest: int) -> bytes:
    try:
        found = unpacker.decompress(data, max_length=largest + 1)
    except (OSError, RuntimeError, ValueError, MemoryError) as error:
        raise _damaged(where, "compressed data", error) from error
    _check_size(len(found), where, largest)
    if not unpacker.eof:
        raise _damaged(where, "compressed data", "it ends too early")
    return found


def _check_size(size: int, where: str, largest: int) -> None:
    if size > largest:
        raise StoreError(f"{where}: more than {largest} bytes when it is unpacked, expected that many at most")


def _damaged(where: str, what: str, error: object) -> StoreError:
    return StoreError(f"{where}: {what} that cannot be unpacked ({error}), expected what a recorder wrote")
