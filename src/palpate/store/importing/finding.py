"""Finding what can be imported among files and folders."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate.errors import PalpateError
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.importing.items import Fate, Format, HoldsMore, Item, Outcome, StatesUnits
from palpate.store.importing.zips import Zips
from palpate.store.store import Store
from palpate.store.units import admit_units

__all__ = ["Found", "count_items", "find"]

UNKNOWN = "of no format that palpate knows"
LINK = "a link: links inside a folder are not followed, give what it points to"


@dataclass(frozen=True)
class Found:
    """A file or folder of a format."""

    path: Path
    format: Format

    def count(self) -> int:
        """How many items there are; one where that cannot be told, as `items` tells what is wrong."""
        try:
            return self.format.count(self.path)
        except (PalpateError, OSError):
            return 1

    def items(self) -> Iterator[Item | Outcome]:
        """The items; where they cannot be read to the end, that is the last one."""
        try:
            yield from self.format.items(self.path)
        except (PalpateError, OSError) as error:
            yield self._refused(error)

    def admit_units(self, store: Store) -> Outcome | None:
        """Let a store that does not know them take over the units of properties; why it cannot, where it cannot."""
        if not isinstance(self.format, StatesUnits):
            return None
        try:
            admit_units(store, self.format.units(self.path))
        except UnavailableError:
            raise
        except (PalpateError, OSError) as error:
            return self._refused(error)
        return None

    def put_more(self, store: Store) -> Iterator[Outcome]:
        """Put what is no recording into a store that has the recordings."""
        if not isinstance(self.format, HoldsMore):
            return
        try:
            yield from self.format.put_more(self.path, store)
        except UnavailableError:
            raise
        except (PalpateError, OSError) as error:
            yield self._refused(error)

    def _refused(self, error: Exception) -> Outcome:
        return Outcome(str(self.path), Fate.REFUSED, told(error, self.path))


def find(paths: Iterable[Path], formats: Sequence[Format], zips: Zips | None = None) -> Iterator[Found | Outcome]:
    """Look at files and folders, and into folders that are of no format themselves.

    Parameters
    ----------
    zips
        Unpacks zip files, which are looked into as folders are; without it they are as other files.

    Yields
    ------
    Found or Outcome
        In alphabetical order; what no format owns is skipped, and so are links inside a folder.
    """
    # paths go as deep as a disk allows, calls do not
    waiting = list(reversed(list(paths)))
    while waiting:
        path = waiting.pop()
        try:
            path = path if zips is None or not zips.owns(path) else zips.unpacked(path)
            owner = next((each for each in formats if each.owns(path)), None)
            inner = sorted(path.iterdir()) if owner is None and path.is_dir() else None
        except (OSError, StoreError) as error:
            yield Outcome(str(path), Fate.REFUSED, told(error, path))
            continue
        if owner is not None:
            yield Found(path, owner)
        elif inner is None:
            yield Outcome(str(path), Fate.SKIPPED, UNKNOWN)
        else:
            yield from (Outcome(str(link), Fate.SKIPPED, LINK) for link in inner if link.is_symlink())
            waiting += [one for one in reversed(inner) if not one.is_symlink()]


def count_items(paths: Iterable[Path], formats: Sequence[Format], zips: Zips | None = None) -> int:
    """How many outcomes an import of these paths will have."""
    return sum(one.count() if isinstance(one, Found) else 1 for one in find(paths, formats, zips))


def told(error: Exception, source: Path | str) -> str:
    """What an error says, without the place that stands before it already."""
    if isinstance(error, OSError):
        place = "" if error.filename is None or str(error.filename) == str(source) else f"{error.filename} "
        return f"{place}cannot be read: {error.strerror or error}"
    if isinstance(error, RecursionError):
        return "is nested too deeply to be read"
    text = str(error)
    return next(
        (text.removeprefix(f"{source}{end}") for end in (": ", " ", "/") if text.startswith(f"{source}{end}")), text
    )
