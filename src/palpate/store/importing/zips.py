"""Folders packed as zip files: they are imported as if they were unpacked where they are."""

from __future__ import annotations

import os
import re
import shutil
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Self

from palpate.store.errors import StoreError
from palpate.store.importing.items import Outcome
from palpate.store.importing.paths import portable_name
from palpate.store.importing.saving import Saved, is_zip

__all__ = ["Zips"]


class Zips:
    """Unpacks zip files into the folder for temporary files, where they stay until the end of a ``with`` statement.

    What is in them is held to what is held an upload to: nothing lands elsewhere, and a link becomes a file.

    Examples
    --------
    ::

        with Zips() as zips:
            outcomes = list(import_paths(store, [Path("session.zip")], all_formats(), zips=zips))
    """

    def __init__(self) -> None:
        self._done = dict[Path, Path | StoreError]()

    @cached_property
    def _kept(self) -> TemporaryDirectory[str]:
        return TemporaryDirectory(prefix="palpate-zips-")

    @property
    def _root(self) -> Path:
        return Path(self._kept.name)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._done:
            self._kept.cleanup()

    def owns(self, path: Path) -> bool:
        """Tell whether it is to be unpacked: a zip in a zip is not, as on a server."""
        return is_zip(path.name) and path.is_file() and not (self._done and self._root in path.parents)

    def unpacked(self, path: Path) -> Path:
        """The folder of what is in a file; it is unpacked once.

        Raises
        ------
        StoreError
            If it is damaged, there is no room for it, or a name in it leads elsewhere.
        OSError
            If it cannot be read.
        """
        if path not in self._done:
            self._done[path] = self._unpack(path, self._root / str(len(self._done)))
        found = self._done[path]
        if isinstance(found, StoreError):
            raise found
        return found

    def _unpack(self, path: Path, folder: Path) -> Path | StoreError:
        name = portable_name(path.name)
        folder.mkdir()
        saved = Saved(folder, shutil.disk_usage(self._root).free)
        try:
            with path.open("rb") as opened:
                saved.put(name, opened)
        except StoreError as error:
            return StoreError(str(error).removeprefix(f"{name}: "))
        return folder / name

    def named(self, outcome: Outcome) -> Outcome:
        """An outcome that names the zip file in the place of the folder into which it was unpacked."""
        if not self._done:
            return outcome
        reason = None if outcome.reason is None else self._told(outcome.reason)
        return replace(outcome, source=self._told(outcome.source), reason=reason)

    def _told(self, text: str) -> str:
        paths = list(self._done.items())
        for number in set(re.findall(re.escape(f"{self._root}{os.sep}") + r"(\d+)", text)):
            path, folder = paths[int(number)]
            text = text.replace(str(folder), str(path))
        return text
