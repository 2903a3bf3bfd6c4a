"""Where the files of one recording are: in a folder, or in memory where they are few bytes."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from functools import lru_cache
from io import BytesIO
from math import prod
from pathlib import Path
from typing import Any, Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from palpate.store.errors import DamagedError
from palpate.store.importing.folder import JOURNAL, checksum
from palpate.store.importing.paths import check_name, inside

__all__ = ["Folder", "InMemory", "Kept"]

NPY = b"\x93NUMPY\x01\x00"
NPY_BYTES = 10
"""Of the beginning of an array, before the header that says what it holds."""


class Kept(Protocol):
    """The files of a recording, by their names; ``str`` says where they are."""

    def named(self, name: str) -> str:
        """A file as errors call it."""

    def read(self, name: str) -> bytes | None:
        """What is in a file of a fixed name; None where there is none."""

    def array(self, name: str) -> NDArray[Any]:
        """An array; raises DamagedError where there is none that can be read."""

    def file(self, name: str) -> tuple[bytes | Path, int]:
        """What is in a file, and its checksum; raises DamagedError where it is missing."""


class Folder:
    """A folder on the disk."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __str__(self) -> str:
        return str(self._path)

    def named(self, name: str) -> str:
        """Its path."""
        return str(self._path / name)

    def read(self, name: str) -> bytes | None:
        """What is in a file."""
        try:
            return (self._path / name).read_bytes()
        except FileNotFoundError:
            return None

    def array(self, name: str) -> NDArray[Any]:
        """An array."""
        path = self._verified_path(name)
        try:
            array: NDArray[Any] = np.load(path, allow_pickle=False)
        except (EOFError, OSError, ValueError) as error:
            raise DamagedError(f"{path}: is no readable array ({error})") from error
        return array

    def file(self, name: str) -> tuple[Path, int]:
        """Where a file is, so that it is read when it is needed."""
        path = self._verified_path(name)
        return path, checksum(path)

    def _verified_path(self, name: str) -> Path:
        path = inside(self._path, name, self.named(JOURNAL))
        if not path.is_file():
            raise DamagedError(f"{path}: is missing")
        return path


class InMemory:
    """Files that were unpacked into memory."""

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self._files = files

    def __str__(self) -> str:
        return "package"

    def named(self, name: str) -> str:
        """Its name."""
        return name

    def read(self, name: str) -> bytes | None:
        """What is in a file."""
        return self._files.get(name)

    def array(self, name: str) -> NDArray[Any]:
        """An array."""
        data = self._data(name)
        try:
            return _array(data)
        except (EOFError, OSError, ValueError) as error:
            raise DamagedError(f"{name}: is no readable array ({error})") from error

    def file(self, name: str) -> tuple[bytes, int]:
        """What is in a file."""
        data = self._data(name)
        return data, crc32(data)

    def _data(self, name: str) -> bytes:
        found = self._files.get(check_name(name, JOURNAL))
        if found is None:
            raise DamagedError(f"{name}: is missing")
        return found


def _array(data: bytes) -> NDArray[Any]:
    """An array, by NumPy's own reader unless it is laid out as all of ours are."""
    header = data[NPY_BYTES : NPY_BYTES + struct.unpack_from("<H", data, 8)[0]] if data[:8] == NPY else b""
    shape, fortran, dtype = _header(header) if header else ((), True, np.dtype(object))
    samples = memoryview(data)[NPY_BYTES + len(header) :]
    if fortran or dtype.hasobject or len(samples) != prod(shape) * dtype.itemsize or not len(samples):
        loaded: NDArray[Any] = np.load(BytesIO(data), allow_pickle=False)
        return loaded
    return np.frombuffer(samples, dtype).reshape(shape)


@lru_cache(maxsize=256)
def _header(header: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, order and type of an array: NumPy takes longer to parse that than all else of a small one."""
    found: tuple[tuple[int, ...], bool, np.dtype[Any]] = np.lib.format.read_array_header_1_0(
        BytesIO(struct.pack("<H", len(header)) + header)
    )
    return found
