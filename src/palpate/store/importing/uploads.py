"""Recordings from "upload dictionaries"; what each leaves open is decided by `Conventions` and told in its notices."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path, PureWindowsPath
from typing import Any, Protocol
from uuid import NAMESPACE_URL, uuid5

import numpy as np

from palpate.errors import LogError
from palpate.store.checks import check
from palpate.store.errors import StoreError
from palpate.store.importing.paths import inside, media_type_of
from palpate.store.importing.upload_entries import entries_in
from palpate.store.importing.upload_format import AS_PUBLISHED, Conventions, UploadDictionary, files_in
from palpate.store.records import DEVICE_KINDS, Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef

__all__ = ["Answer", "Imported", "import_uploads", "read_upload"]

NOWHERE = "unnamed"
"""The dataset of an object whose file names none."""


class Answer(Protocol):
    """What a store answers when it has taken a recording; its receipts are such answers."""

    @property
    def new(self) -> bool:
        """Whether the store did not have it before."""


@dataclass(frozen=True, eq=False)
class Imported:
    """What became of one file.

    Attributes
    ----------
    recording
        What was read; None where the file was refused.
    new
        Whether the store did not have it already.
    reason
        Why it was refused; None where it was taken.
    """

    file: Path
    recording: Recording | None
    new: bool
    reason: str | None


def import_uploads(
    paths: str | Path | Iterable[str | Path],
    put: Callable[[Recording], Answer],
    conventions: Conventions = AS_PUBLISHED,
) -> Iterator[Imported]:
    """Put the measurements of upload dictionaries into a store, one by one, and tell what became of each.

    What was imported before is found again and is not imported twice, so that an import that was
    broken off can be run again.

    Parameters
    ----------
    paths
        Files, folders of such files, or both.
    put
        What takes a recording, such as the method of a store.

    Raises
    ------
    LogError
        If a folder has no such file. What is wrong inside a file is told in its `Imported`.
    """
    for file in files_in(paths):
        try:
            recording = read_upload(file, conventions)
            receipt = put(recording)
        except (LogError, StoreError) as error:
            yield Imported(file, None, new=False, reason=str(error).removeprefix(f"{file}: "))
        else:
            yield Imported(file, recording, new=receipt.new, reason=None)


def read_upload(file: Path, conventions: Conventions = AS_PUBLISHED) -> Recording:
    """Read an upload dictionary; the same file always gives the same recording, under the same id.

    Raises
    ------
    LogError, StoreError
        If it cannot be read, or holds what a store does not keep.
    """
    dictionary = UploadDictionary.read(file)
    notices: list[str] = []
    name = str(dictionary.at("entry", "name"))
    repository = dictionary.mapping("entry").get("repository")
    series, files = _signals(dictionary, conventions, notices)
    recording = Recording(
        recorded_at=_moment(dictionary, notices),
        action=conventions.actions.get(name, name),
        thing=_thing(dictionary, notices),
        setup=_setup(dictionary),
        repository=repository if isinstance(repository, str) else None,
        grasp=_grasp(dictionary),
        gripper_pose=_pose(dictionary, "gripper_pose", notices),
        object_pose=_pose(dictionary, "object_pose", notices),
        series=series,
        files=(*files, _original(dictionary)),
        entries=entries_in(dictionary, conventions, notices),
    )
    recording = replace(recording, notices=tuple(notices))
    check(recording)
    return replace(recording, id=uuid5(NAMESPACE_URL, f"palpate:{recording.digest}"))


def _moment(dictionary: UploadDictionary, notices: list[str]) -> datetime:
    try:
        moment = datetime.strptime(dictionary.time, "%Y_%m_%d_%H_%M_%S").replace(tzinfo=UTC)
    except ValueError:
        found = f"the time in the name is {dictionary.time!r}"
        raise LogError(f"{dictionary.file}: {found}, expected year_month_day_hour_minute_second") from None
    notices.append("the time is the one in the file's name, which states no time zone: UTC is assumed")
    return moment


def _thing(dictionary: UploadDictionary, notices: list[str]) -> ThingRef:
    given = dict(dictionary.mapping("measurement", "object_instance"))
    common_name, dataset, known_as, maker = (
        given.pop(key, None) for key in ("common_name", "dataset", "dataset_id", "maker")
    )
    if dataset is None or known_as is None:
        notices.append("no data set with an id in it is named: the object's common name is its id")
        dataset, known_as = dataset or NOWHERE, known_as or common_name
    return ThingRef(dataset, known_as, maker, common_name, {key: value for key, value in given.items() if value})


def _setup(dictionary: UploadDictionary) -> Setup:
    """The devices; what is of no known kind is among the others, with the word that the file has for it."""
    given = {kind: name for kind, name in dictionary.mapping("measurement", "setup").items() if name is not None}
    named = {kind: Device(kind, given.pop(kind)) for kind in DEVICE_KINDS[:-1] if kind in given}
    others = (Device("other", name, parameters={"kind": kind}) for kind, name in sorted(given.items()))
    return Setup(**named, other=tuple(others))


def _grasp(dictionary: UploadDictionary) -> Mapping[str, Any] | None:
    grasp = dictionary.mapping("measurement").get("grasp")
    return grasp if grasp is None or isinstance(grasp, Mapping) else {"given": grasp}


def _pose(dictionary: UploadDictionary, key: str, notices: list[str]) -> Pose | None:
    given = dictionary.mapping("measurement").get(key)
    if given is None:
        return None
    place = given.get("translation") if isinstance(given, Mapping) else None
    if not isinstance(place, list) or len(place) != 3 or not all(isinstance(part, int | float) for part in place):
        raise LogError(f"{dictionary.file}: measurement.{key}: expected an object with a translation of three numbers")
    notices.append(
        f"{key} states no units and no frame: metres are assumed; its rotation has no convention and is kept as given"
    )
    return Pose((place[0], place[1], place[2]), None, "unstated", given)


def _signals(
    dictionary: UploadDictionary, conventions: Conventions, notices: list[str]
) -> tuple[tuple[Series, ...], list[FileItem]]:
    samples, paths = dictionary.signals()
    devices: dict[str, list[Channel]] = {}
    units = dict(conventions.from_series.values())
    for full, values in samples.items():
        device, _, name = full.rpartition(".")
        quantity = conventions.quantities.get(name, name)
        devices.setdefault(device, []).append(Channel(name, quantity, units.get(name), np.asarray(values)))
        if name in conventions.remarks:
            notices.append(f"{full} {conventions.remarks[name]}")
    found = (_file(dictionary, channel, path, notices) for channel, path in paths.items())
    series = tuple(Series(device, tuple(channels)) for device, channels in devices.items())
    return series, [item for item in found if item is not None]


def _file(dictionary: UploadDictionary, channel: str, name: str, notices: list[str]) -> FileItem | None:
    """The file of a signal where it is in the dictionary's folder; otherwise what is wrong is noticed."""
    # the folders are another computer's; Windows' rules split both kinds of path
    short = PureWindowsPath(name).name
    try:
        path = inside(Path(dictionary.file).parent, name, channel)
    except StoreError:
        notices.append(f"the file of {channel}, {short!r}, is refused: its path leads out of the dictionary's folder")
        return None
    if not path.is_file():
        notices.append(f"the file of {channel}, {short!r}, is not there")
        return None
    return FileItem(f"{channel.replace('.', '/')}{path.suffix}", media_type_of(path.name), path)


def _original(dictionary: UploadDictionary) -> FileItem:
    """The entry as it was given, with null in place of what JSON does not have."""
    text = json.dumps(_finite(dictionary.mapping("entry")), ensure_ascii=True, allow_nan=False, indent=1)
    return FileItem("entry.json", "application/json", text.encode())


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    return [_finite(item) for item in value] if isinstance(value, list) else value
