"""What a recording is, as bytes: a JSON document, and after it the raw arrays and the log; their SHA-256 is its digest.

The store keeps the very document that was hashed, so that what is read can be checked against the digest to the bit.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef
from palpate.store.remembering import remembered

__all__ = [
    "canonical_array",
    "channel_arrays",
    "document",
    "entry_plain",
    "file_digest",
    "layout_plain",
    "layout_text",
    "pose_plain",
    "recording_digest",
    "setup_digest",
    "setup_plain",
    "thing_plain",
    "to_json",
]

KINDS: Mapping[type, str] = {
    Value: "value",
    Distribution: "distribution",
    Interval: "interval",
    Bound: "bound",
    FailedEntry: "failed",
}
# values that hold themselves end the recursion too, and looking for them takes as long as writing the rest
_encode = json.JSONEncoder(
    sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False, check_circular=False
).encode
LAYOUT = ("name", "quantity", "unit", "rate_hz", "dtype", "shape", "timed")
ChannelLayout = tuple[str, str, str | None, float | None, str, tuple[int, ...], bool]


def to_json(plain: Any) -> str:
    """The one way to write a value as JSON: keys sorted, no spaces, no NaN.

    Examples
    --------
    >>> to_json({"b": 0.1, "a": [1]})
    '{"a":[1],"b":0.1}'
    """
    return _encode(plain)


def recording_digest(recording: Recording) -> str:
    """SHA-256 of the document, the arrays and the log of a recording, in hexadecimal digits."""
    return digest_of(recording.document.encode(), _arrays(recording), recording.log.encode())


def digest_of(text: bytes, arrays: Iterable[NDArray[Any]], log: bytes) -> str:
    """The digest of a recording from its parts, as they are made and as they are stored."""
    hashed = sha256(text)
    for array in arrays:
        hashed.update(array.data if array.size else b"")
    hashed.update(log)
    return hashed.hexdigest()


def document(recording: Recording) -> str:
    """All of a recording but its id, visibility, embargo, arrays, files and log, as JSON.

    Raises
    ------
    ValueError, TypeError
        If a value is none that JSON can hold, which `palpate.store.checks.check` finds and names before.
    """
    # keys are sorted; what says how the series are laid out is the longest part, and nearly always the same
    before = {
        "action": recording.action,
        "entries": [entry_plain(entry) for entry in recording.entries],
        "files": [_file_plain(item) for item in recording.files],
        "grasp": recording.grasp,
        "gripper_pose": pose_plain(recording.gripper_pose),
        "ground_truth": bool(recording.ground_truth),
        "licence": recording.licence,
        "log_bytes": len(recording.log.encode()),
        "notices": recording.notices,
        "object_pose": pose_plain(recording.object_pose),
        "owner": recording.owner,
        "recorded_at": in_utc(recording.recorded_at),
        "repository": recording.repository,
    }
    after = {
        "setup": recording.setup.digest,
        "software": recording.software,
        "thing": (recording.thing.dataset, recording.thing.id),
    }
    series = ",".join(map(_series_text, recording.series))
    return f'{to_json(before)[:-1]},"series":[{series}],{to_json(after)[1:]}'


def in_utc(moment: datetime) -> str:
    """A moment in UTC to the microsecond."""
    return moment.astimezone(UTC).isoformat(timespec="microseconds").removesuffix("+00:00") + "Z"


def entry_plain(entry: Entry) -> dict[str, Any]:
    """An entry as JSON can hold it; ``kind`` says which it is."""
    plain: dict[str, Any] = {"kind": KINDS[type(entry)]}
    for name, value in vars(entry).items():
        if isinstance(value, Mapping):
            plain[name] = {label: float(probability) for label, probability in value.items()}
        else:
            plain[name] = value if value is None or isinstance(value, str) else float(value)
    return plain


def setup_plain(setup: Setup) -> dict[str, Any]:
    """A setup as JSON can hold it."""
    named = ("arm", "gripper", "camera", "microphone")
    plain: dict[str, Any] = {name: device_plain(getattr(setup, name)) for name in named}
    return {**plain, "other": [device_plain(device) for device in setup.other]}


def device_plain(device: Device | None) -> dict[str, Any] | None:
    """A device as JSON can hold it."""
    return None if device is None else dict(vars(device))


def setup_digest(setup: Setup) -> str:
    """SHA-256 of what a setup is, in hexadecimal digits."""
    return sha256(to_json(setup_plain(setup)).encode()).hexdigest()


def thing_plain(thing: ThingRef) -> dict[str, Any]:
    """An object as JSON can hold it."""
    return {**vars(thing), "aliases": list(thing.aliases)}


def layout_plain(series: Series) -> list[dict[str, Any]]:
    """What the arrays of a series are, without how many samples they have."""
    return _layout_plain(_layout(series))


def layout_text(series: Series) -> str:
    """`layout_plain` as JSON."""
    return _layout_text(_layout(series))


def _layout(series: Series) -> tuple[ChannelLayout, ...]:
    return tuple(
        (
            channel.name,
            channel.quantity,
            channel.unit,
            None if channel.rate_hz is None else float(channel.rate_hz),
            canonical_dtype(channel.values.dtype).str,
            channel.values.shape[1:],
            channel.time_s is not None,
        )
        for channel in series.channels
    )


def _layout_plain(layout: Iterable[ChannelLayout]) -> list[dict[str, Any]]:
    return [dict(zip(LAYOUT, channel, strict=True)) for channel in layout]


@remembered(1024)
def _layout_text(layout: tuple[ChannelLayout, ...]) -> str:
    return to_json(_layout_plain(layout))


def channel_arrays(channel: Channel) -> Iterator[NDArray[Any]]:
    """The arrays of a channel in the order in which they are hashed and stored: values, then time stamps."""
    yield canonical_array(channel.values)
    if channel.time_s is not None:
        yield canonical_array(channel.time_s)


def canonical_array(array: NDArray[Any]) -> NDArray[Any]:
    """The same numbers in one piece and little-endian."""
    return np.ascontiguousarray(array, dtype=canonical_dtype(array.dtype))


def canonical_dtype(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """The same type of number, little-endian."""
    return dtype.newbyteorder("<") if dtype.byteorder == ">" else dtype


def file_digest(data: bytes | Path) -> str:
    """SHA-256 of what is in a file, in hexadecimal digits."""
    if isinstance(data, bytes):
        return sha256(data).hexdigest()
    hashed = sha256()
    with data.open("rb") as opened:
        while piece := opened.read(1 << 20):
            hashed.update(piece)
    return hashed.hexdigest()


def _arrays(recording: Recording) -> Iterator[NDArray[Any]]:
    return (array for series in recording.series for channel in series.channels for array in channel_arrays(channel))


def _series_text(series: Series) -> str:
    counts = ",".join([str(len(channel.values)) for channel in series.channels])
    return f'{{"channels":{series.layout},"counts":[{counts}],"name":{to_json(series.name)}}}'


def _file_plain(item: FileItem) -> dict[str, Any]:
    return {"name": item.name, "media_type": item.media_type, "sha256": item.sha256}


def pose_plain(pose: Pose | None) -> dict[str, Any] | None:
    """A pose as it is kept; None where there is none."""
    if pose is None:
        return None
    turn = None if pose.quaternion is None else [float(part) for part in pose.quaternion]
    place = [float(part) for part in pose.translation_m]
    return {"translation_m": place, "quaternion": turn, "frame": pose.frame, "original": pose.original}
