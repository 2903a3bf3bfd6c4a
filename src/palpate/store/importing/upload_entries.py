"""What the entry of an upload dictionary becomes in a store; each decision is added to a list of notices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from palpate.errors import LogError
from palpate.store.entries import Distribution, Entry, FailedEntry, Value
from palpate.store.importing.upload_format import Conventions, UploadDictionary

__all__ = ["entries_in"]


def entries_in(dictionary: UploadDictionary, conventions: Conventions, notices: list[str]) -> tuple[Entry, ...]:
    """Read the entries: probabilities of labels as they are, a number for each value, a mean of a series."""
    name = str(dictionary.at("entry", "name"))
    property = conventions.properties.get(name, name)
    if dictionary.at("entry", "type") == "categorical":
        return (_distribution(dictionary, property, conventions, notices),)
    if name in conventions.from_series:
        return (_mean_of_series(dictionary, property, *conventions.from_series[name], notices),)
    dictionary.first_value()
    values = dictionary.at("entry", "values")
    return tuple(_value(dictionary, place, value, conventions, notices) for place, value in enumerate(values))


def _distribution(dictionary: UploadDictionary, property: str, conventions: Conventions, notices: list[str]) -> Entry:
    """All labels are kept, also those that no network knows: which it knows is for the network to say."""
    probabilities = dictionary.probabilities()
    for label, group in conventions.groups.items():
        if label in probabilities and not set(group) & set(probabilities):
            notices.append(f"the label {label!r} may stand for {' or '.join(group)}: it is kept as it is")
    return Distribution(property, probabilities)


def _mean_of_series(dictionary: UploadDictionary, property: str, channel: str, unit: str, notices: list[str]) -> Entry:
    given = dictionary.first_value()
    told = f"the entry (mean {given.get('mean')}, std {given.get('std')}) is derived, not measured: it is no result"
    series, _ = dictionary.signals()
    samples = next((values for key, values in series.items() if key.rpartition(".")[2] == channel), ())
    if not samples or not all(math.isfinite(sample) for sample in samples):
        notices.append(f"{channel} has no samples or some that are not finite; {told}")
        return FailedEntry(f"no usable samples of {channel}", property)
    notices.append(
        f"the {property} is the mean of {len(samples)} samples of {channel} in {unit}, without an SD; {told}"
    )
    return Value(property, math.fsum(samples) / len(samples), None, unit)


def _value(dictionary: UploadDictionary, place: int, given: Any, conventions: Conventions, notices: list[str]) -> Entry:
    if not isinstance(given, Mapping):
        raise LogError(f"{dictionary.file}: entry.values[{place}]: expected an object")
    name = str(given.get("name") or dictionary.at("entry", "name"))
    property = conventions.properties.get(name, name)
    mean, sd, unit = given.get("mean"), given.get("std"), given.get("units")
    if isinstance(mean, bool) or not isinstance(mean, int | float) or not math.isfinite(mean):
        spread = "" if sd is None else f" (std {sd})"
        notices.append(f"the mean of {property} is {mean} and not a number: this is a failed measurement{spread}")
        return FailedEntry(f"the mean is {mean}", property)
    if unit is None:
        unit = conventions.units.get(name)
        notices.append(f"{property} has no unit: {f'{unit} is assumed' if unit else 'none is assumed'}")
    if sd is not None and not (isinstance(sd, int | float) and math.isfinite(sd) and sd >= 0):
        notices.append(f"the std of {property} is {sd} and no SD: it is left out")
        sd = None
    return Value(property, float(mean), None if sd is None else float(sd), unit)
