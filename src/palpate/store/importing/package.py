"""A recording as one file, a zip of its folder: the form in which it is sent."""

from __future__ import annotations

import shutil
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile

from palpate.store.errors import StoreError
from palpate.store.importing.folder import JOURNAL, write_folder
from palpate.store.importing.kept import Folder, InMemory, Kept
from palpate.store.importing.reading_folder import read_kept
from palpate.store.records import Recording

__all__ = ["LARGEST_BYTES", "pack", "pack_folder", "unpack"]

LARGEST_BYTES = 4 << 30
"""What a package may hold at most when it is unpacked, unless told."""
IN_MEMORY_BYTES = 1 << 20
"""What is unpacked into memory: making and removing files takes longer than all else there is to do."""
FOLDERS, UNNAMED = frozenset("/\\:"), ("", ".", "..")
"""What stands between folders on some system, and names of none."""


def pack(recording: Recording, file: IO[bytes]) -> None:
    """Write a recording as a package."""
    with TemporaryDirectory() as name:
        write_folder(recording, Path(name), sync=False)
        pack_folder(Path(name), file)


def pack_folder(folder: Path, file: IO[bytes]) -> None:
    """Write the folder of a recording as a package."""
    with ZipFile(file, "w", ZIP_DEFLATED, compresslevel=1) as package:
        for path in sorted(folder.iterdir()):
            package.write(path, path.name)


def unpack(
    file: IO[bytes],
    folder: Callable[[], Path],
    *,
    largest_bytes: int = LARGEST_BYTES,
    largest_journal_bytes: int = LARGEST_BYTES,
) -> Recording:
    """Read a package that anybody may have sent.

    Parameters
    ----------
    folder
        Gives an empty folder, where the files of a large recording are until they are read; those of a small one are
        in memory, and none is asked for.
    largest_bytes, largest_journal_bytes
        Of all that is unpacked, and of what is said of the measurement, which takes long to read.

    Raises
    ------
    StoreError
        If it is no package, is too large, holds names that are none of a recording, or is damaged.
    """
    try:
        with ZipFile(file) as package:
            total = sum(item.file_size for item in package.infolist())
            if total > largest_bytes:
                raise StoreError(f"package: {total} bytes when unpacked, expected {largest_bytes} at most")
            for item in package.infolist():
                if item.filename == JOURNAL and item.file_size > largest_journal_bytes:
                    told = f"{item.file_size} bytes when unpacked, expected {largest_journal_bytes} at most"
                    raise StoreError(f"package: {JOURNAL} has {told}")
                if item.filename in UNNAMED or not FOLDERS.isdisjoint(item.filename):
                    raise StoreError(f"package: the name {item.filename!r} has folders in it, expected plain names")
            kept = _in_memory(package) if total <= IN_MEMORY_BYTES else _in_folder(package, folder())
    except (BadZipFile, EOFError, FileExistsError, RuntimeError, ValueError, struct.error, zlib.error) as error:
        if isinstance(error, StoreError):
            raise
        raise StoreError(f"package: cannot be unpacked ({error}), expected a zip of one recording") from error
    return read_kept(kept)


def _in_memory(package: ZipFile) -> Kept:
    found = dict[str, bytes]()
    for item in package.infolist():
        if item.filename in found:
            raise FileExistsError(f"two files are called {item.filename!r}")
        with package.open(item) as source:
            # no more than it says it has, as whole it may be unpacked to anything; CRC-32 tells where that is wrong
            found[item.filename] = source.read(item.file_size + 1)
    return InMemory(found)


def _in_folder(package: ZipFile, folder: Path) -> Kept:
    for item in package.infolist():
        # a package that says it is smaller than it is ends in BadZipFile
        with package.open(item) as source, (folder / item.filename).open("xb") as target:
            shutil.copyfileobj(source, target)
    return Folder(folder)
