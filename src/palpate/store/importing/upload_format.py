"""The format of "upload dictionaries", and what a lab means by what they do not say.

Each file ``upload_dict_<time>_<entry>_<number>.json`` holds a measurement (object, setup, poses,
raw signals) and an entry, what was made of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palpate.errors import LogError
from palpate.store.errors import StoreError
from palpate.store.importing.json_text import read_json

__all__ = ["AS_PUBLISHED", "FILE_NAME", "FORM", "NAMED_SO", "TIME", "Conventions", "UploadDictionary", "files_in"]

FILE_NAME = re.compile(r"upload_dict_(?P<time>[\d_]*\d)_(?P<name>[^\d_].*)\.json")

FORM = "upload_dict_<time>_<entry>_<number>.json"
"""The form of the files' names, for people."""
TIME = "%Y_%m_%d_%H_%M_%S"
EXAMPLE = "upload_dict_2024_05_01_12_00_00_elasticity_0.json"
NAMED_SO = re.compile(r"upload_dict.*\.json", re.IGNORECASE)
"""Names by which a file is meant to be one, whether or not they are of the form."""


@dataclass(frozen=True)
class Conventions:
    """What the files of a lab mean, and do not say.

    Parameters
    ----------
    actions
        Name of an entry to the action it is of; an entry that is not named is its own action.
    properties
        Name of an entry to the property it tells about; an entry that is not named is its own property.
    units
        Name of an entry to the unit of its mean where the file gives none.
    from_series
        Name of an entry that was computed from a series to that channel and its unit: the outcome
        is the mean of the series, and the entry is kept but never used as evidence.
    quantities
        Channel to the quantity that it holds; a channel that is not named is its own quantity.
    groups
        A classifier's label to the states it stands for: in a vector its probability is split
        among them by the network's prior, and as a label it is the first of them.
    remarks
        Channel to what is odd about it.
    """

    actions: Mapping[str, str] = field(default_factory=dict)
    properties: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    from_series: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    quantities: Mapping[str, str] = field(default_factory=dict)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    remarks: Mapping[str, str] = field(default_factory=dict)


AS_PUBLISHED = Conventions(
    actions={"elasticity": "squeezing", "density": "weighing"},
    properties={"cat-vision": "category", "mat-vision": "material", "mat-sound": "material", "density": "mass"},
    units={"elasticity": "kPa"},
    from_series={"density": ("joint4_torque", "g")},
    quantities={"joint4_torque": "mass", "time": "index"},
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
            told = "as it tells the entry and, as year_month_day_hour_minute_second, the time"
            raise LogError(f"{path}: a name of the form {FORM} was expected, such as {EXAMPLE}, {told}")
        try:
            content = read_json(path)
        except StoreError as error:
            raise LogError(str(error)) from error
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

    def signals(self) -> tuple[dict[str, Sequence[float]], dict[str, str]]:
        """Return the numeric series and the paths of the signals' files as given, by device and channel.

        Raises
        ------
        LogError
            If a channel is neither.
        """
        series: dict[str, Sequence[float]] = {}
        files: dict[str, str] = {}
        for device in self.mapping("measurement", "sensor_outputs"):
            for channel, signal in self.mapping("measurement", "sensor_outputs", device).items():
                if isinstance(signal, str):
                    files[f"{device}.{channel}"] = signal
                elif isinstance(signal, list) and all(isinstance(sample, int | float) for sample in signal):
                    series[f"{device}.{channel}"] = signal
                else:
                    where = f"{self.file}: measurement.sensor_outputs.{device}.{channel}"
                    raise LogError(f"{where}: a list of numbers or the path of a file was expected")
        return series, files

    def probabilities(self) -> dict[str, float]:
        """Return a categorical entry's labels with their probabilities; LogError if it has none."""
        self.first_value()
        found = {}
        for value in self.at("entry", "values"):
            name, p = (value.get(key) if isinstance(value, Mapping) else None for key in ("name", "probability"))
            if not isinstance(name, str) or not isinstance(p, int | float):
                raise LogError(f"{self.file}: entry.values: a name and a probability were expected in each")
            found[name] = float(p)
        return found


def files_in(paths: str | Path | Iterable[str | Path]) -> list[Path]:
    """Return the files named, and those in the folders named, each once; LogError for a folder without any."""
    found: dict[Path, None] = {}
    for path in map(Path, [paths] if isinstance(paths, str | Path) else paths):
        inside = sorted(p for p in path.glob("*.json") if FILE_NAME.fullmatch(p.name)) if path.is_dir() else [path]
        if not inside:
            raise LogError(f"{path}: no file {FORM} was found")
        found |= dict.fromkeys(inside)
    return list(found)
