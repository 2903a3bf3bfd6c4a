"""Reading the folder of a recording: one that is whole, or what is left of one that is not."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from zlib import crc32

from numpy.typing import NDArray

from palpate.store.entries import FailedEntry
from palpate.store.errors import DamagedError, StoreError
from palpate.store.importing.folder import FORMAT, JOURNAL, LOG
from palpate.store.importing.kept import Folder, Kept
from palpate.store.importing.plain import FIELDS, LATER, decode, updated
from palpate.store.records import Channel, FileItem, Recording, Series

__all__ = ["is_whole", "read_folder", "read_kept", "read_remainder", "stated_digest"]

Line = Mapping[str, Any]


def read_folder(folder: Path) -> Recording:
    """Read a whole recording; its files are read from the folder when they are needed.

    Raises
    ------
    StoreError, DamagedError
        As `read_kept`.
    """
    return read_kept(Folder(folder))


def read_kept(folder: Kept) -> Recording:
    """Read a whole recording from where its files are.

    Raises
    ------
    StoreError
        If the folder holds none, or one that is not whole.
    DamagedError
        If an array, a file or anything else is missing or is not what was written.
    """
    lines = _lines(folder)
    if not lines or "end" not in lines[-1]:
        raise StoreError(f"{folder}: the recording is not whole, expected a last line with 'end' in {JOURNAL}")
    recording = replace(_recording(folder, lines), log=_log(folder))
    for line in lines:
        recording = _with_signals(recording, folder, line)
    if recording.digest != lines[-1]["end"]:
        raise DamagedError(f"{folder}: this is not what was written, expected the digest {lines[-1]['end']}")
    return recording


def read_remainder(path: Path, reason: str) -> Recording:
    """Read what is left of a recording whose measurement did not end, as one that failed.

    Parameters
    ----------
    reason
        Why it did not end.

    Raises
    ------
    StoreError
        If not even the beginning is left.
    """
    folder = Folder(path)
    lines = _lines(folder)
    recording = replace(_recording(folder, lines), log=_log(folder))
    notices = []
    for line in lines:
        try:
            recording = _with_signals(recording, folder, line)
        except DamagedError as error:
            notices.append(f"left out: {str(error).removeprefix(f'{folder}/')}")
    failed = FailedEntry(reason)
    return replace(recording, entries=(*recording.entries, failed), notices=(*recording.notices, *notices))


def is_whole(folder: Path) -> bool:
    """Tell whether the journal has its last line."""
    lines = _lines(Folder(folder))
    return bool(lines) and "end" in lines[-1]


def stated_digest(folder: Path) -> str | None:
    """The digest that the last line of the journal states; None where there is none."""
    lines = _lines(Folder(folder))
    digest = lines[-1].get("end") if lines else None
    return digest if isinstance(digest, str) else None


def _lines(folder: Kept) -> list[Line]:
    """The journal up to its last whole line; the one after it may be cut off."""
    text = folder.read(JOURNAL) or b""
    rows = text[: text.rfind(b"\n") + 1].splitlines()
    return [_line(f"{folder.named(JOURNAL)} line {number}", row) for number, row in enumerate(rows, 1)]


def _line(where: str, row: bytes) -> Line:
    try:
        line = json.loads(row)
    except (ValueError, RecursionError) as error:
        raise DamagedError(f"{where}: is no readable JSON ({error})") from error
    if not isinstance(line, dict):
        raise DamagedError(f"{where}: {type(line).__name__} was found, expected a JSON object")
    return line


def _recording(folder: Kept, lines: list[Line]) -> Recording:
    """The recording without its series and files."""
    if not lines:
        raise StoreError(f"{folder}: no recording was found, expected a first line in {JOURNAL}")
    header = dict(lines[0])
    if header.pop("format", None) != FORMAT:
        raise StoreError(f"{folder.named(JOURNAL)}: the format is {lines[0].get('format')!r}, expected {FORMAT!r}")
    fields = decode(header, folder.named(JOURNAL))
    missing = [name for name in FIELDS if name not in fields and name not in LATER]
    if missing:
        raise DamagedError(
            f"{folder.named(JOURNAL)} line 1: {missing[0]!r} is missing, expected all fields of a recording"
        )
    recording = Recording(**fields)
    for line in lines[1:]:
        later = {name: value for name, value in line.items() if name not in _SIGNALS and name != "end"}
        recording = updated(recording, decode(later, folder.named(JOURNAL)))
    return recording


def _log(folder: Kept) -> str:
    return (folder.read(LOG) or b"").decode("utf-8", "backslashreplace")


def _with_signals(recording: Recording, folder: Kept, line: Line) -> Recording:
    """The recording with the series or the file that a line names."""
    for name, read in _SIGNALS.items():
        if name in line:
            try:
                return read(recording, folder, line[name])
            except (AttributeError, KeyError, TypeError) as error:
                raise DamagedError(f"{folder.named(JOURNAL)}: {name!r} cannot be read ({error!r})") from error
    return recording


def _with_series(recording: Recording, folder: Kept, plain: Any) -> Recording:
    channels = tuple(
        Channel(
            name=channel["name"],
            quantity=channel["quantity"],
            unit=channel["unit"],
            values=_array(folder, channel["values"]),
            rate_hz=channel["rate_hz"],
            time_s=channel["time_s"] and _array(folder, channel["time_s"]),
        )
        for channel in plain["channels"]
    )
    return replace(recording, series=(*recording.series, Series(plain["name"], channels)))


def _array(folder: Kept, plain: Any) -> NDArray[Any]:
    array = folder.array(plain["path"])
    if crc32(array.data if array.flags.c_contiguous and array.size else array.tobytes()) != plain["crc32"]:
        raise DamagedError(f"{folder.named(plain['path'])}: the samples are not the ones that were written")
    return array


def _with_file(recording: Recording, folder: Kept, plain: Any) -> Recording:
    data, found = folder.file(plain["path"])
    if found != plain["crc32"]:
        raise DamagedError(f"{folder.named(plain['path'])}: the content is not the one that was written")
    return replace(recording, files=(*recording.files, FileItem(plain["name"], plain["media_type"], data)))


_SIGNALS: Mapping[str, Callable[[Recording, Kept, Any], Recording]] = {"series": _with_series, "file": _with_file}
