"""Decompression with a limit, as a few bytes may stand for more than a computer holds."""

from __future__ import annotations

import bz2
from pathlib import Path
from typing import Protocol

import zstandard

from palpate.store.errors import StoreError

__all__ = ["LARGEST_BYTES", "LARGEST_FILE_BYTES", "unbz2", "unlz4", "unzstd", "unzstd_file"]

LARGEST_BYTES = 256 << 20
"""What a piece of a bag may hold at most when it is unpacked: a message, or a chunk of them."""

LARGEST_FILE_BYTES = 16 << 30
"""What a file of a bag may hold at most when it is unpacked."""

PIECE_BYTES = 1 << 20


class Unpacker(Protocol):
    """What lz4 and bz2 have in common."""

    @property
    def eof(self) -> bool:
        """Whether all is unpacked."""

    def decompress(self, data: bytes, max_length: int = -1) -> bytes:
        """Unpack at most so much."""


def unzstd(data: bytes, where: str, largest: int = LARGEST_BYTES) -> bytes:
    """Undo zstd; StoreError if it is damaged or holds too much."""
    pieces, size = [], 0
    try:
        with zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True) as reader:
            while piece := reader.read(min(PIECE_BYTES, largest + 1 - size)):
                size += len(piece)
                _check_size(size, where, largest)
                pieces.append(piece)
    except (zstandard.ZstdError, MemoryError) as error:
        raise _damaged(where, "zstd", error) from error
    return b"".join(pieces)


def unzstd_file(packed: Path, unpacked: Path, largest: int = LARGEST_FILE_BYTES) -> None:
    """Undo zstd of a file into another; StoreError if it is damaged or holds too much."""
    size = 0
    try:
        with packed.open("rb") as source, unpacked.open("xb") as target:
            reader = zstandard.ZstdDecompressor().stream_reader(source, read_across_frames=True)
            while piece := reader.read(PIECE_BYTES):
                size += len(piece)
                _check_size(size, packed.name, largest)
                target.write(piece)
    except (zstandard.ZstdError, MemoryError) as error:
        raise _damaged(packed.name, "zstd", error) from error


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
