"""Paths that were named for an import, and of which nothing came: each was meant, and so it is told."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.store.importing.items import Fate, HoldsMore

if TYPE_CHECKING:
    from palpate.store.importing.items import Format, Outcome
    from palpate.store.importing.zips import Zips

__all__ = ["Fruitless"]


class Fruitless:
    """The paths of which nothing came yet.

    Examples
    --------
    >>> from palpate.store.importing.items import Outcome
    >>> left = Fruitless([Path("squeezes"), Path("notes.txt"), Path("old")])
    >>> left.strike(Outcome("squeezes/3.csv", Fate.NEW))
    >>> left.strike(Outcome("notes.txt", Fate.SKIPPED, "of no format"))
    >>> left.strike(Outcome("old: recording 7", Fate.KNOWN))
    >>> [str(path) for path in left.paths]
    ['notes.txt']
    """

    def __init__(self, paths: Iterable[Path]) -> None:
        self._left = {str(path): path for path in paths}

    @property
    def paths(self) -> list[Path]:
        """Those that are left."""
        return list(self._left.values())

    def strike(self, outcome: Outcome) -> None:
        """Strike out what an outcome came of; what was refused is told by itself, what was skipped is nothing."""
        if outcome.fate is Fate.SKIPPED:
            return
        # of several recordings in one folder or file, each has its name after that of the place
        places = [outcome.source, outcome.source.rpartition(": ")[0]]
        # a picture that lies beside the file that names it
        files = () if outcome.recording is None else outcome.recording.files
        for place in (*places, *(str(item.data) for item in files if isinstance(item.data, Path))):
            for path in (Path(place), *Path(place).parents) if place else ():
                self._left.pop(str(path), None)

    def without_more(self, formats: Sequence[Format], zips: Zips) -> list[Path]:
        """Those that are left and do not hold anything but recordings either, as an archive of objects does."""
        from palpate.store.importing.finding import Found, find

        return [
            path
            for path in self.paths
            if not any(
                isinstance(one, Found) and isinstance(one.format, HoldsMore) for one in find([path], formats, zips)
            )
        ]
