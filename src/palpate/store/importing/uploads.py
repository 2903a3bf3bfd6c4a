"""Recordings from "upload dictionaries"; what each leaves open is decided by `Conventions` and told in its notices."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path, PureWindowsPath

from palpate.errors import LogError
from palpate.store.checks import check
from palpate.store.errors import StoreError
from palpate.store.importing.items import Item, identified
from palpate.store.importing.json_text import finite
from palpate.store.importing.measurement_parts import grasp_of, pose_of, series_of, setup_of, thing_of
from palpate.store.importing.paths import inside, media_type_of
from palpate.store.importing.upload_entries import entries_in
from palpate.store.importing.upload_format import AS_PUBLISHED, NAMED_SO, TIME, Conventions, UploadDictionary
from palpate.store.records import FileItem, Recording

__all__ = ["UploadDictionaries", "measurement_of", "read_upload"]


class UploadDictionaries:
    """Single files, known by their names.

    Parameters
    ----------
    conventions
        What the files leave open.
    """

    def __init__(self, conventions: Conventions = AS_PUBLISHED) -> None:
        self.conventions = conventions

    def owns(self, path: Path) -> bool:
        """Tell whether the name begins and ends like theirs; one that is of another form is refused."""
        return NAMED_SO.fullmatch(path.name) is not None and path.is_file()

    def count(self, path: Path) -> int:
        """One."""
        return 1

    def items(self, path: Path) -> Iterator[Item]:
        """The recording."""
        yield Item(str(path), partial(read_upload, path, self.conventions))


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
    recording = measurement_of(dictionary, conventions, notices, action=conventions.actions.get(name, name))
    repository = dictionary.mapping("entry").get("repository")
    recording = replace(
        recording,
        repository=repository if isinstance(repository, str) else None,
        files=(*recording.files, _original(dictionary)),
        entries=entries_in(dictionary, conventions, notices),
    )
    recording = replace(recording, notices=tuple(notices))
    check(recording)
    return identified(recording)


def measurement_of(
    dictionary: UploadDictionary,
    conventions: Conventions,
    notices: list[str],
    *,
    action: str,
    recorded_at: datetime | None = None,
) -> Recording:
    """The measurement of an upload dictionary without what was made of it; what is odd is added to the notices.

    Parameters
    ----------
    action
        What was done.
    recorded_at
        When; unless given, the file's name tells.

    Raises
    ------
    LogError
        If a part is missing, or is not what it should be.
    """
    measurement, where = dictionary.mapping("measurement"), f"{dictionary.file}: measurement."
    samples, paths = dictionary.signals()
    series = series_of(samples, conventions, notices)
    files = [_file(dictionary, channel, path, notices) for channel, path in paths.items()]
    return Recording(
        recorded_at=recorded_at or _moment(dictionary, notices),
        action=action,
        thing=thing_of(dictionary.mapping("measurement", "object_instance"), notices),
        setup=setup_of(dictionary.mapping("measurement", "setup")),
        grasp=grasp_of(measurement),
        gripper_pose=pose_of(measurement, "gripper_pose", where, notices),
        object_pose=pose_of(measurement, "object_pose", where, notices),
        series=series,
        files=tuple(item for item in files if item is not None),
    )


def _moment(dictionary: UploadDictionary, notices: list[str]) -> datetime:
    try:
        moment = datetime.strptime(dictionary.time, TIME).replace(tzinfo=UTC)
    except ValueError:
        found = f"the time in the name is {dictionary.time!r}"
        raise LogError(f"{dictionary.file}: {found}, expected year_month_day_hour_minute_second") from None
    notices.append("the time is the one in the file's name, which states no time zone: UTC is assumed")
    return moment


def _file(dictionary: UploadDictionary, channel: str, name: str, notices: list[str]) -> FileItem | None:
    """The file of a signal where it is in the dictionary's folder; otherwise what is wrong is noticed."""
    # the folders are another computer's; Windows' rules split both kinds of path
    short, folder = PureWindowsPath(name).name, Path(dictionary.file).parent
    try:
        if PureWindowsPath(name).root and (beside := inside(folder, short, channel)).is_file():
            notices.append(f"the file of {channel}, {short!r}, is the one beside it: its path is another computer's")
            return FileItem(_name_of(channel, beside), media_type_of(beside.name), beside)
        path = inside(folder, name, channel)
    except StoreError:
        notices.append(f"the file of {channel}, {short!r}, is refused: its path leads out of the dictionary's folder")
        return None
    if not path.is_file():
        notices.append(f"the file of {channel}, {short!r}, is not there")
        return None
    return FileItem(_name_of(channel, path), media_type_of(path.name), path)


def _name_of(channel: str, path: Path) -> str:
    return f"{channel.replace('.', '/')}{path.suffix}"


def _original(dictionary: UploadDictionary) -> FileItem:
    """The entry as it was given, with null in place of what JSON does not have."""
    text = json.dumps(finite(dictionary.mapping("entry")), ensure_ascii=True, allow_nan=False, indent=1)
    return FileItem("entry.json", "application/json", text.encode())
