"""The results that a Butler's measurement states, in the words of an upload dictionary's entry."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from palpate.errors import LogError
from palpate.network.document import is_number
from palpate.store.entries import Entry
from palpate.store.importing.butler_folder import RESULT, Logged
from palpate.store.importing.upload_entries import entries_in
from palpate.store.importing.upload_format import Conventions, UploadDictionary

__all__ = ["entries_of"]

Value = Mapping[str, Any]
PROPERTIES = ("meas_prop", "property", "property_name")
WORDS = {"mean": ("mean", "value"), "std": ("std", "sigma", "sd"), "units": ("units", "unit"), "name": ("name",)}
"""Words of an upload dictionary, with those that stand for the same."""
SUM_TOLERANCE = 1e-6


def entries_of(
    logged: Logged, given: Mapping[str, Any], signals: Mapping[str, Any], conventions: Conventions
) -> tuple[Entry, ...]:
    """Read the results in `given`, the content of ``measurement.json``; what cannot be read is noticed.

    Parameters
    ----------
    signals
        Samples by device and channel, from some of which a result may be computed.
    """
    found = list(_stated(given))
    if given and not found:
        logged.notices.append(f"{RESULT} states no result that can be read: there is none")
    return tuple(entry for one in found for entry in _entries(logged, one, signals, conventions))


def _entries(
    logged: Logged, stated: Mapping[str, Any], signals: Mapping[str, Any], conventions: Conventions
) -> Sequence[Entry]:
    name = next((stated[key] for key in (*PROPERTIES, "name") if isinstance(stated.get(key), str)), None)
    if not name:
        logged.notices.append(f"the result names no property: {logged.action!r} is assumed, as the folder says")
        name = logged.action
    values = [_in_words(value, stated) for value in _values(stated)]
    is_labels = any("probability" in value for value in values)
    entry = {"name": name, "type": "categorical" if is_labels else "continuous", "values": values}
    content = {"measurement": {"sensor_outputs": signals}, "entry": entry}
    dictionary = UploadDictionary(str(logged.folder), logged.folder.name, "", content)
    try:
        return entries_in(dictionary, _own(conventions, name, signals), logged.notices)
    except LogError as error:
        reason = str(error).removeprefix(f"{logged.folder}: ")
        logged.notices.append(f"the result of {name} cannot be read ({reason}): it is kept in {RESULT} alone")
        return ()


def _stated(given: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """The results: one or several under ``entry``, or the measurement itself."""
    entry = given.get("entry", given)
    for one in entry if isinstance(entry, list) else [entry]:
        if isinstance(one, dict) and any(key in one for key in (*PROPERTIES, "values", "params")):
            yield one


def _values(stated: Mapping[str, Any]) -> list[Value]:
    """The values under ``values`` or ``params``, whichever form they have; none where that is not clear."""
    for found in (stated.get("values"), stated.get("params")):
        if isinstance(found, list) and found and all(isinstance(value, dict) for value in found):
            return found
        if isinstance(found, dict) and _word(found, "mean") is not None:
            return [found]
        if isinstance(found, dict) and _is_distribution(found, stated):
            return [{"name": label, "probability": p} for label, p in found.items()]
        if is_number(found):
            return [{**stated, "mean": found, "name": None}]
    return [stated] if _word(stated, "mean") is not None else []


def _is_distribution(found: Mapping[str, Any], stated: Mapping[str, Any]) -> bool:
    """Whether numbers by name are probabilities of labels: it is said so, or they sum to one."""
    if not found or not all(map(is_number, found.values())):
        return False
    kind = stated.get("meas_type", stated.get("type"))
    return kind == "categorical" or (kind is None and abs(math.fsum(found.values()) - 1) < SUM_TOLERANCE)


def _in_words(value: Value, stated: Mapping[str, Any]) -> Value:
    """A value in the words of an upload dictionary; a unit may stand beside the values."""
    if "probability" in value:
        return value
    found = {word: value[key] for word in WORDS if (key := _word(value, word)) is not None}
    unit = _word(stated, "units")
    return {"units": stated[unit], **found} if unit is not None and found.get("units") is None else found


def _word(value: Value, word: str) -> str | None:
    """The key that stands for a word, if there is one."""
    return next((key for key in WORDS[word] if key in value), None)


def _own(conventions: Conventions, name: str, signals: Mapping[str, Any]) -> Conventions:
    """The conventions without one that computes this result from a series that was not logged."""
    channel, _ = conventions.from_series.get(name, (None, None))
    if channel is None or any(channel in channels for channels in signals.values()):
        return conventions
    properties = {key: property for key, property in conventions.properties.items() if key != name}
    return replace(conventions, from_series={}, properties=properties)
