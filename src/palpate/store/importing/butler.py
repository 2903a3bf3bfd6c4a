"""Trees of experiments as the Butler writes them.

``experiment_<time>/setup.json`` names the devices; each folder ``<action>_<number>`` beside it is a measurement, with
``log.txt``, ``data/measurement.json``, ``data/object_context.json``, and any files in ``data``, ``imgs`` and ``figs``.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from palpate.store.importing.butler_folder import EXPERIMENT, MEASUREMENT, SETUP
from palpate.store.importing.butler_measurement import AS_LOGGED, read_measurement
from palpate.store.importing.finding import LINK
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.importing.upload_format import Conventions

__all__ = ["ButlerExperiments"]

STRANGE = "is no folder <action>_<number> of a measurement"
PARTS = ("data", "imgs", "figs", "log.txt")


class ButlerExperiments:
    """The folder of an experiment.

    Parameters
    ----------
    conventions
        What the files leave open.
    """

    def __init__(self, conventions: Conventions = AS_LOGGED) -> None:
        self.conventions = conventions

    def owns(self, path: Path) -> bool:
        """Tell whether the folder has the name of an experiment, and a setup or a measurement in it."""
        if not EXPERIMENT.fullmatch(path.name) or not path.is_dir():
            return False
        return (path / SETUP).exists() or any(_is_measurement(inner) for inner in path.iterdir())

    def count(self, path: Path) -> int:
        """The folders and files in it but the setup."""
        return sum(inner.name != SETUP for inner in path.iterdir())

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """The measurements; what else is there is skipped."""
        for inner in sorted(path.iterdir()):
            if inner.name == SETUP:
                continue
            if inner.is_symlink():
                yield Outcome(str(inner), Fate.SKIPPED, LINK)
            elif inner.is_dir() and MEASUREMENT.fullmatch(inner.name):
                yield Item(str(inner), partial(read_measurement, inner, self.conventions))
            else:
                yield Outcome(str(inner), Fate.SKIPPED, STRANGE)


def _is_measurement(folder: Path) -> bool:
    named = MEASUREMENT.fullmatch(folder.name) is not None
    return named and any((folder / part).exists() for part in PARTS)
