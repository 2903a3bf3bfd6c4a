"""Series and files in the folder of a Butler's measurement."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path, PureWindowsPath
from typing import Any

from palpate.store.errors import StoreError
from palpate.store.importing.butler_folder import CONTEXT, LOG, RESULT, Logged
from palpate.store.importing.json_text import read_json
from palpate.store.importing.paths import inside, leads_inside, media_type_of, portable_name
from palpate.store.records import FileItem

__all__ = ["files_below", "signals_in"]

LARGEST_JSON_BYTES = 32 << 20
"""Larger files are not parsed."""
LARGEST_EXACT = 1 << 53
Channels = dict[str, list[float]]


def signals_in(logged: Logged, given: Any) -> tuple[dict[str, Channels], set[str]]:
    """Samples by device and channel, and the names of the files that hold nothing else.

    Parameters
    ----------
    given
        The ``sensor_outputs`` of the measurement: samples, or paths of files, by device and channel.
    """
    signals = dict(_outputs(logged, given if isinstance(given, dict) else {}))
    used = set()
    for name in sorted(_data_files(logged.folder)):
        found = _devices(logged.folder / name)
        twice = sorted(set(found) & set(signals))
        if twice:
            logged.notices.append(f"{name}: there are samples of {twice[0]} already: it is kept as a file")
        elif found:
            signals |= found
            used.add(name)
    return signals, used


def _outputs(logged: Logged, given: Mapping[str, Any]) -> Iterator[tuple[str, Channels]]:
    """Devices with their samples; paths are only looked at."""
    for device, channels in given.items():
        rest = channels
        if isinstance(channels, dict):
            for name, path in channels.items():
                if isinstance(path, str):
                    _check_path(logged, f"{device}.{name}", path)
            rest = {name: samples for name, samples in channels.items() if not isinstance(samples, str)}
        samples = _channels(rest)
        if samples is not None:
            yield device, samples
        elif rest != {}:
            logged.notices.append(f"{device} holds no lists of numbers of one length: it is kept in {RESULT} alone")


def _check_path(logged: Logged, channel: str, name: str) -> None:
    """Notice where a path leads: the files of the folder are kept whether a path names them or not."""
    # the folders are another computer's; Windows' rules split both kinds of path
    short = PureWindowsPath(name).name
    try:
        if not inside(logged.folder, name, channel).is_file():
            logged.notices.append(f"the file of {channel}, {short!r}, is not there")
    except StoreError:
        logged.notices.append(f"the path of the file of {channel}, {short!r}, leads out of the folder: it is not read")


def files_below(logged: Logged, used: Collection[str]) -> tuple[FileItem, ...]:
    """All files but the log and those in `used`; what lies outside the folder is refused, which is noticed."""
    files: dict[str, FileItem] = {}
    for path in _below(logged.folder):
        given = path.relative_to(logged.folder).as_posix()
        name = portable_name(given)
        if not leads_inside(logged.folder, path):
            logged.notices.append(f"the file {name!r} is refused: it is a link that leads out of its folder")
        elif given == LOG or given in used:
            continue
        elif name in files or not path.is_file():
            logged.notices.append(f"{name!r} is left out: it is {'a second one' if name in files else 'no file'}")
        else:
            if name != given:
                logged.notices.append(f"the file {name!r} is renamed, as not every computer allows its own name")
            files[name] = FileItem(name, media_type_of(name), path)
    return tuple(files.values())


def _below(folder: Path) -> Iterator[Path]:
    """All that is no folder, in the order of names; links are not followed."""
    for place, folders, names in os.walk(folder):
        folders.sort()
        links = [name for name in folders if (Path(place) / name).is_symlink()]
        yield from (Path(place) / name for name in sorted([*names, *links]))


def _data_files(folder: Path) -> Iterator[str]:
    """Files in ``data`` that may hold samples."""
    for path in (folder / "data").glob("*.json"):
        name = f"data/{path.name}"
        ours = name not in (RESULT, CONTEXT) and leads_inside(folder, path) and path.is_file()
        if ours and path.stat().st_size <= LARGEST_JSON_BYTES:
            yield name


def _devices(path: Path) -> dict[str, Channels]:
    """The samples in a file, where it is clear what they are: a list, lists by channel, or those by device."""
    try:
        found = read_json(path)
    except StoreError:
        return {}
    if _is_samples(found):
        return {path.stem: {path.stem: found}}
    channels = _channels(found)
    if channels is not None:
        return {path.stem: channels}
    devices = {name: _channels(part) for name, part in found.items()} if _is_table(found) else {}
    whole = {name: channels for name, channels in devices.items() if channels is not None}
    return whole if len(whole) == len(devices) else {}


def _channels(given: Any) -> Channels | None:
    """Lists of numbers of one length, by channel; None for anything else."""
    if not _is_table(given) or not all(name and _is_samples(samples) for name, samples in given.items()):
        return None
    return given if len({len(samples) for samples in given.values()}) == 1 else None


def _is_table(given: Any) -> bool:
    return isinstance(given, dict) and bool(given)


def _is_samples(given: Any) -> bool:
    return isinstance(given, list) and bool(given) and all(map(_is_sample, given))


def _is_sample(value: Any) -> bool:
    # a whole number may be rounded where it stands among others
    return isinstance(value, float) or (type(value) is int and abs(value) <= LARGEST_EXACT)
