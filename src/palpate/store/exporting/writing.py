"""An export: written beside its place and renamed, so that it is there whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from palpate.store.errors import StoreError
from palpate.store.exporting.selection import Selection
from palpate.store.filters import Filter
from palpate.store.store import Store

__all__ = ["Format", "Told", "Written", "export", "new_folder"]

Told = Callable[[int, int], None]
"""Is told how many recordings are done, and of how many."""


@dataclass(frozen=True)
class Written:
    """What became of an export: how many recordings are in it, what is not and why, and how many are not public."""

    recordings: int
    notices: tuple[str, ...] = ()
    withheld: int = 0


class Format(Protocol):
    """How measurements are written."""

    def write(self, selection: Selection, folder: Path, told: Told) -> Written:
        """Write the recordings into an empty folder."""


def export(
    store: Store, form: Format, folder: str | Path, wanted: Filter | None = None, told: Told = lambda done, of: None
) -> Written:
    """Write recordings into a new folder, as the store is now; it appears whole or not at all.

    Parameters
    ----------
    store
        Where they are.
    form
        How they are written: `palpate.store.archive.Archive`,
        `palpate.store.exporting.tables.Tables`, `palpate.store.exporting.hugging_face.HuggingFace` or
        `palpate.store.exporting.lerobot.dataset.LeRobot`.
    folder
        Must not exist yet.
    wanted
        Which recordings; all, unless given.
    told
        Is told how far it is.

    Raises
    ------
    StoreError
        If the folder exists, or the format cannot hold the recordings.
    DamagedError
        If a recording is not what was put into the store.
    """
    with new_folder(Path(folder)) as draft, Selection.of(store, wanted) as selection:
        return form.write(selection, draft, told)


@contextmanager
def new_folder(folder: Path) -> Iterator[Path]:
    """A folder beside, which gets the name if nothing goes wrong and vanishes otherwise.

    Raises
    ------
    StoreError
        If there is something of that name.
    """
    if folder.exists():
        raise StoreError(f"{folder}: exists already, expected the name of a new folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        yield draft
        draft.chmod(0o755)
        draft.rename(folder)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
