"""The format of "upload dictionaries", and what a lab means by what they do not say.

Each file ``upload_dict_<time>_<entry>_<number>.json`` holds a measurement (object, setup, poses,
raw signals) and an entry, what was made of it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palpate.errors import LogError

__all__ = ["AS_PUBLISHED", "FILE_NAME", "FORM", "Conventions", "UploadDictionary"]

FILE_NAME = re.compile(r"upload_dict_(?P<time>[\d_]*\d)_(?P<name>[^\d_].*)\.json")

FORM = "upload_dict_<time>_<entry>_<number>.json"
"""The form of the files' names, for people."""


@dataclass(frozen=True)
class Conventions:
    """What the files of a lab mean, and do not say.

    Parameters
    ----------
    actions
        Name of an entry to the action it is of; an entry that is not named is its own action.
    units
        Name of an entry to the unit of its mean where the file gives none.
    from_series
        Name of an entry that was computed from a series to that channel and its unit: the outcome
        is the mean of the series, and the entry is kept but never used as evidence.
    groups
        A classifier's label to the states it stands for: in a vector its probability is split
        among them by the network's prior, and as a label it is the first of them.
    remarks
        Channel to what is odd about it.
    """

    actions: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    from_series: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    remarks: Mapping[str, str] = field(default_factory=dict)


AS_PUBLISHED = Conventions(
    actions={"elasticity": "squeezing", "density": "weighing"},
    units={"elasticity": "kPa"},
    from_series={"density": ("joint4_torque", "g")},
    groups={"plastic": ("soft-plastic", "hard-plastic")},
    remarks={
        "joint4_torque": "holds grams and not a torque, as its mean against the object's true mass shows",
        "time": "is an index resampled to evenly spaced values and not a time; it is kept as it is",
    },
)
"""The conventions of the paper's setup."""


@dataclass(frozen=True)
class UploadDictionary:
    """One file: its path for messages, its recording's name, the time in its name, its content."""

    file: str
    name: str
    time: str
    content: Mapping[str, Any]

    @classmethod
    def read(cls, path: Path) -> UploadDictionary:
        """Read a file; LogError if its name has another form than `FILE_NAME`, or it is no JSON."""
        match = FILE_NAME.fullmatch(path.name)
        if not match:
            raise LogError(f"{path}: a name of the form {FORM} was expected, as it tells the entry and the time")
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise LogError(f"{path} cannot be read: {error.strerror or error}") from error
        except ValueError as error:
            raise LogError(f"{path}: this is no readable JSON: {error}") from error
        return cls(str(path), match["name"], match["time"], content)

    def at(self, *keys: str) -> Any:
        """Return what stands under the keys; LogError names the first that is missing."""
        found: Any = self.content
        for depth, key in enumerate(keys):
            if not isinstance(found, Mapping) or key not in found:
                raise LogError(f"{self.file}: {'.'.join(keys[: depth + 1])} is missing")
            found = found[key]
        return found

    def mapping(self, *keys: str) -> Mapping[str, Any]:
        """Return the object under the keys; LogError if it is missing or something else."""
        found = self.at(*keys)
        if not isinstance(found, Mapping):
            raise LogError(f"{self.file}: {'.'.join(keys)} was expected to be an object")
        return found

    def first_value(self) -> Mapping[str, Any]:
        """Return the first of the entry's values; LogError if there is none."""
        values = self.at("entry", "values")
        if not isinstance(values, list) or not values or not isinstance(values[0], Mapping):
            raise LogError(f"{self.file}: entry.values was expected to be a list with an object in it")
        return values[0]
