"""The folder of one measurement in a Butler's experiment: its names, its tables and its log."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from palpate.store.errors import StoreError
from palpate.store.importing.json_text import read_json
from palpate.store.importing.paths import inside

__all__ = ["CONTEXT", "EXPERIMENT", "LOG", "MEASUREMENT", "RESULT", "SETUP", "Logged"]

EXPERIMENT = re.compile("experiment_(?P<time>.+)", re.DOTALL)
MEASUREMENT = re.compile(r"(?P<action>.+)_(?P<number>\d+)", re.DOTALL)
TIME = "%Y_%m_%d_%H_%M_%S"
SETUP, LOG = "setup.json", "log.txt"
RESULT, CONTEXT = "data/measurement.json", "data/object_context.json"


@dataclass(frozen=True)
class Logged:
    """A folder that is being read, and what was odd about it so far."""

    folder: Path
    notices: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Experiment and measurement, for people."""
        return f"{self.folder.parent.name}/{self.folder.name}"

    @property
    def action(self) -> str:
        """What the folder's name says was done."""
        named = MEASUREMENT.fullmatch(self.folder.name)
        return named["action"] if named else self.folder.name

    def moment(self) -> datetime:
        """When the experiment began.

        Raises
        ------
        StoreError
            If the experiment's name tells no time.
        """
        experiment = self.folder.parent.name
        named = EXPERIMENT.fullmatch(experiment)
        try:
            moment = datetime.strptime(named["time"] if named else "", TIME).replace(tzinfo=UTC)
        except ValueError:
            expected = "expected experiment_<year>_<month>_<day>_<hour>_<minute>_<second>"
            raise StoreError(f"{self.folder}: the time in the name {experiment!r} cannot be read, {expected}") from None
        # the name of the folder also keeps two measurements with the same content apart
        self.notices.append(
            f"the time of {self.folder.name} is that of its experiment, which states no time zone: UTC is assumed"
        )
        return moment

    def table(self, name: str) -> Mapping[str, Any]:
        """The object in a file of the measurement; empty where there is none, which is noticed."""
        return self._table(self.folder, name)

    def setup(self) -> Mapping[str, Any]:
        """The object in the setup of the experiment."""
        return self._table(self.folder.parent, SETUP)

    def log(self) -> str:
        """What was printed."""
        try:
            path = inside(self.folder, LOG, LOG)
            if not path.is_file():
                return ""
            return path.read_text(encoding="utf-8", errors="backslashreplace")
        except StoreError:
            # told with the files
            return ""

    def _table(self, folder: Path, name: str) -> Mapping[str, Any]:
        try:
            path = inside(folder, name, name)
            if not path.is_file():
                raise StoreError(f"{name} is missing")
            found = read_json(path)
            if not isinstance(found, dict):
                raise StoreError(f"{name} holds {type(found).__name__} and no object")
        except StoreError as error:
            self.notices.append(str(error).removeprefix(f"{folder}/"))
            return {}
        return found
