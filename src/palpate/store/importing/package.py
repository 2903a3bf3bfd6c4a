"""A recording as one file, a zip of its folder: the form in which it is sent."""

from __future__ import annotations

import shutil
import struct
import zlib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile

from palpate.store.errors import StoreError
from palpate.store.importing.folder import write_folder
from palpate.store.importing.reading_folder import read_folder
from palpate.store.records import Recording

__all__ = ["LARGEST_BYTES", "pack", "unpack"]

LARGEST_BYTES = 4 << 30
"""What a package may hold at most when it is unpacked, unless told."""


def pack(recording: Recording, file: IO[bytes]) -> None:
    """Write a recording as a package."""
    with TemporaryDirectory() as name, ZipFile(file, "w", ZIP_DEFLATED, compresslevel=1) as package:
        folder = Path(name)
        write_folder(recording, folder, sync=False)
        for path in sorted(folder.iterdir()):
            package.write(path, path.name)


def unpack(file: IO[bytes], folder: Path, *, largest_bytes: int = LARGEST_BYTES) -> Recording:
    """Read a package that anybody may have sent.

    Parameters
    ----------
    folder
        An empty folder, where the files of the recording are until they are read.

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
                if Path(item.filename).name != item.filename or "\\" in item.filename or ":" in item.filename:
                    raise StoreError(f"package: the name {item.filename!r} has folders in it, expected plain names")
                # a package that says it is smaller than it is ends in BadZipFile
                with package.open(item) as source, (folder / item.filename).open("xb") as target:
                    shutil.copyfileobj(source, target)
    except (BadZipFile, EOFError, FileExistsError, RuntimeError, ValueError, struct.error, zlib.error) as error:
        if isinstance(error, StoreError):
            raise
        raise StoreError(f"package: cannot be unpacked ({error}), expected a zip of one recording") from error
    return read_folder(folder)
