"""A measurement of the old program as a recording: the same rules as for an upload dictionary in a file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import PurePosixPath
from typing import Any

from palpate.errors import LogError
from palpate.server.rest.forms import Form, Part
from palpate.store.entries import Entry
from palpate.store.errors import StoreError
from palpate.store.importing.json_text import finite
from palpate.store.importing.paths import media_type_of, portable_name
from palpate.store.importing.upload_entries import entries_in
from palpate.store.importing.upload_format import AS_PUBLISHED, UploadDictionary
from palpate.store.importing.uploads import measurement_of
from palpate.store.records import FileItem, Recording

__all__ = ["entries_given", "file_of_json", "recording_of_form"]

UNKNOWN_ACTION = "measuring"
PARAMETERS = re.compile(r"param[a-z]*")
PICTURE = "picture"
"""What the old program called the measurement's png."""
NO_TIME = "the form states no time: that of the upload is taken"


def recording_of_form(form: Form) -> Recording:
    """The recording of a form of ``/rest/measurements/``; owner and visibility are for others to say.

    Raises
    ------
    LogError, StoreError
        If it holds none.
    """
    content, notices = form.content, form.notices
    if not isinstance(content, dict) or not isinstance(content.get("measurement"), dict):
        raise StoreError("measurement: expected JSON with an object 'measurement' in it")
    given = [*_listed(content.get("entries")), *([] if content.get("entry") is None else [content["entry"]])]
    as_sent = {key: finite(value) for key, value in content.items() if key != "measurement"}
    as_sent["measurement"] = finite({k: v for k, v in content["measurement"].items() if k != "sensor_outputs"})
    parts = _placed(form)
    dictionary = UploadDictionary(str(form.folder / "form"), "", "", content)
    action, entries = entries_given(dictionary, given, notices)
    notices.append(NO_TIME)
    now = datetime.now(UTC)
    recording = measurement_of(dictionary, AS_PUBLISHED, notices, action=action, recorded_at=now)
    repositories = [one.get("repository") for one in given if isinstance(one.get("repository"), str)]
    truths = [content["measurement"].get("consider_this_ground_truth"), *(one.get("ground_truth") for one in given)]
    return replace(
        recording,
        entries=entries,
        repository=repositories[0] if repositories else None,
        ground_truth=truths[0] is True or (len(truths) > 1 and all(one is True for one in truths[1:])),
        files=(*recording.files, *_files(parts, notices), file_of_json("form.json", as_sent)),
    )


def entries_given(
    dictionary: UploadDictionary, given: list[dict[str, Any]], notices: list[str]
) -> tuple[str, tuple[Entry, ...]]:
    """What was done, as the first of the entries tells, and the results of all."""
    if not given:
        notices.append(f"no entry tells what was done: the action is called {UNKNOWN_ACTION!r}")
    found = list[Entry]()
    for one in given:
        content = {**dictionary.content, "entry": _with_means(one)}
        found += entries_in(replace(dictionary, content=content), AS_PUBLISHED, notices)
    name = str(given[0].get("name")) if given else UNKNOWN_ACTION
    return AS_PUBLISHED.actions.get(name, name), tuple(found)


def file_of_json(name: str, plain: Any) -> FileItem:
    """JSON as a file of a recording."""
    return FileItem(name, "application/json", json.dumps(plain, allow_nan=False, indent=1).encode())


def _listed(given: Any) -> list[dict[str, Any]]:
    if given is None:
        return []
    if not isinstance(given, list) or not all(isinstance(one, dict) for one in given):
        raise StoreError("entries: expected a list of objects")
    return given


def _with_means(entry: Any) -> Any:
    """The entry with the name ``mean`` for the number of each value, which may also be called ``value``."""
    if not isinstance(entry, dict):
        raise LogError("entry: expected an object")
    values = entry.get("values")
    if not isinstance(values, list) or entry.get("type") == "categorical":
        return entry
    renamed = [{"mean": one["value"], **one} if isinstance(one, Mapping) and "value" in one else one for one in values]
    return {**entry, "values": renamed}


@dataclass(frozen=True)
class Placed:
    """A file of a form that is of no signal, and the name that it has in the recording."""

    name: str
    part: Part


def _placed(form: Form) -> list[Placed]:
    """Let the signals name the files that came, and give the files that are of no signal.

    The names of the fields are those of the old program: ``measurement <device> <channel>``, ``measurement png``,
    ``measurement object_instance``, ``entry values <name>``, and ``png``.
    """
    measurement, rest = form.content["measurement"], dict(form.parts)
    for device, outputs in _devices(measurement):
        for channel, value in list(outputs.items()):
            if PARAMETERS.search(channel) and isinstance(value, Mapping):
                _add_parameters(measurement, device, outputs.pop(channel))
                continue
            part = rest.pop(f"measurement {device} {channel}", None)
            if part is not None:
                outputs[channel] = part.path.name
    return [Placed(_name_of(key), part) for key, part in rest.items()]


def _devices(measurement: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    outputs = measurement.get("sensor_outputs")
    if isinstance(outputs, dict):
        yield from ((device, found) for device, found in outputs.items() if isinstance(found, dict))


def _add_parameters(measurement: dict[str, Any], device: str, parameters: Mapping[str, Any]) -> None:
    """Parameters that stand among a device's signals are those of the device."""
    setup = measurement.get("setup")
    if isinstance(setup, dict):
        told = {**parameters, "name": device}
        measurement["setup"] = {kind: told if name == device else name for kind, name in setup.items()}


def _name_of(key: str) -> str:
    words = key.split(" ")
    if words[:2] == ["entry", "values"]:
        return f"entry/{' '.join(words[2:])}"
    if key in ("png", "measurement png"):
        return PICTURE
    return " ".join(words[1:]) if words[0] == "measurement" and len(words) > 1 else key


def _files(placed: list[Placed], notices: list[str]) -> Iterator[FileItem]:
    for one in placed:
        stem = "/".join(portable_name(part) or "_" for part in one.name.split("/"))
        ending = PurePosixPath(one.part.name).suffix
        name = stem if stem.endswith(ending) else f"{stem}{ending}"
        if one.name not in (PICTURE, "object_instance") and not one.name.startswith("entry/"):
            notices.append(f"the file {one.name[:100]!r} belongs to no signal that the form names: it is kept")
        yield FileItem(name, media_type_of(one.part.name), one.part.path)
