"""Files that somebody sends, under their names in a folder, with packed ones unpacked: nothing lands elsewhere."""

from __future__ import annotations

import shutil
import zlib
from pathlib import Path
from typing import IO
from zipfile import BadZipFile, ZipFile

from palpate.store.errors import StoreError
from palpate.store.importing.paths import check_name

__all__ = ["Saved", "is_zip"]

LONGEST_NAME = 200
DEEPEST = 20


class Saved:
    """Saves files into a folder.

    Parameters
    ----------
    folder
        An empty one; where it is removed meanwhile, it is not made again.
    largest_bytes
        Of all of them together, unpacked.
    """

    def __init__(self, folder: Path, largest_bytes: int) -> None:
        self.folder = folder
        self.largest_bytes = largest_bytes
        self._left = largest_bytes

    def put(self, name: str, data: IO[bytes]) -> None:
        """Save a file, or what is packed in it.

        Raises
        ------
        StoreError
            If its name leads elsewhere or is there, it is damaged, or there would be too much.
        """
        target = self._target(name)
        if is_zip(name):
            self._unpack(name, data, target)
        else:
            self._write(name, data, target)

    def _target(self, name: str) -> Path:
        plain = check_name(name, "name")
        parts = plain.split("/")
        if len(parts) > DEEPEST or any(len(part.encode("utf-8", "replace")) > LONGEST_NAME for part in parts):
            raise StoreError("name: is too long or too deep for a file")
        target = self.folder.joinpath(*parts)
        if target.exists() or target.is_symlink():
            raise StoreError(f"name: there is a second file {name!r}, expected names of their own")
        try:
            for level in reversed(target.relative_to(self.folder).parents[:-1]):
                (self.folder / level).mkdir(exist_ok=True)
        except (FileExistsError, NotADirectoryError, ValueError):
            raise StoreError(f"name: {name!r} is in a folder that is a file") from None
        return target

    def _write(self, name: str, data: IO[bytes], target: Path) -> None:
        with target.open("xb") as opened:
            while self._left >= 0 and (piece := data.read(1 << 20)):
                self._left -= len(piece)
                opened.write(piece if self._left >= 0 else b"")
        if self._left < 0:
            # its beginning would be read as if it were all
            target.unlink()
            raise StoreError(f"{name}: {self._too_much()}")

    def _too_much(self) -> str:
        return f"all is more than {self.largest_bytes} bytes when unpacked"

    def _unpack(self, name: str, data: IO[bytes], target: Path) -> None:
        """Each file of a zip below a folder that is called as it is; a link in it becomes a file."""
        try:
            with ZipFile(data) as packed:
                if sum(item.file_size for item in packed.infolist()) > self._left:
                    raise StoreError(self._too_much())
                target.mkdir()
                inside = Saved(target, self._left)
                for item in packed.infolist():
                    if not item.is_dir():
                        with packed.open(item) as opened:
                            inside._write(item.filename, opened, inside._target(item.filename))
                self._left = inside._left
        except StoreError as error:
            shutil.rmtree(target, ignore_errors=True)
            told = str(error).removeprefix("name: ")
            raise StoreError(f"{name}: {told}") from None
        except (BadZipFile, EOFError, NotImplementedError, OSError, RuntimeError, ValueError, zlib.error) as error:
            shutil.rmtree(target, ignore_errors=True)
            raise StoreError(f"{name}: cannot be unpacked ({error})") from None


def is_zip(name: str) -> bool:
    """Whether a file of this name is unpacked."""
    return name.lower().endswith(".zip")
