"""An export: written beside its place and renamed, so that it is there whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from palpate.errors import plural
from palpate.store.errors import DamagedError, StoreError
from palpate.store.exporting.selection import Selection
from palpate.store.fetching import Broken
from palpate.store.filters import Filter
from palpate.store.store import Store

__all__ = ["Format", "Told", "Written", "export", "new_folder"]

SHOWN = 3
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
    store: Store,
    form: Format,
    folder: str | Path,
    wanted: Filter | None = None,
    told: Told = lambda done, of: None,
    *,
    leave_out_damaged: bool = False,
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
    leave_out_damaged
        Whether recordings that are not what was put into the store are left out, and named in the notices. All are read
        once more for it.

    Raises
    ------
    StoreError
        If the folder exists, or the format cannot hold the recordings.
    DamagedError
        If recordings are not what was put into the store, and shall not be left out.
    """
    with new_folder(Path(folder)) as draft, Selection.of(store, wanted) as selection:
        left = selection.damaged() if leave_out_damaged else []
        without = frozenset(one.row for one in left)
        try:
            written = form.write(replace(selection, without=without, forgiving=leave_out_damaged), draft, told)
        except DamagedError as error:
            if leave_out_damaged:
                raise
            raise _refusal(selection.damaged(), error) from None
        return replace(written, notices=(*written.notices, *(f"{one}; left out" for one in left)))


def _refusal(found: Sequence[Broken], error: DamagedError) -> DamagedError:
    """Which recordings cannot be exported, or what else was wrong, and what can be done."""
    told = ", ".join(map(str, found[:SHOWN])) + (f" and {len(found) - SHOWN} more" if len(found) > SHOWN else "")
    what = f"{plural(len(found), 'recording')} not as written: {told}" if found else str(error)
    return DamagedError(
        f"export: {what}; nothing was exported (leave_out_damaged, --leave-out-damaged, exports the rest)"
    )


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
