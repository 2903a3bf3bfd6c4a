"""The rows that a recording becomes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from typing import Any

from palpate.store.arrays import pack_bytes, pack_series
from palpate.store.blobs import Blobs
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.known_units import are_alike, factor_of
from palpate.store.records import Recording
from palpate.store.registry import Registry, units_in
from palpate.store.seals import seal_of

__all__ = [
    "IN_ROW_BYTES",
    "Prepared",
    "counted",
    "entry_columns",
    "entry_rows",
    "gripper_of",
    "has_wrong_unit",
    "microseconds",
    "moment_at",
    "prepare",
]

IN_ROW_BYTES = 1 << 16
"""Larger arrays and logs go to the blobs."""
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
MICROSECOND = timedelta(microseconds=1)
Row = dict[str, Any]


def microseconds(moment: datetime) -> int:
    """A moment as it stands in the tables."""
    return (moment - EPOCH) // MICROSECOND


def moment_at(us: int) -> datetime:
    """The moment that stands in the tables as so many microseconds.

    Examples
    --------
    >>> print(moment_at(1_700_000_000_000_000))
    2023-11-14 22:13:20+00:00
    """
    return EPOCH + timedelta(microseconds=us)


@dataclass(frozen=True)
class Prepared:
    """A recording with all that can be made of it before a transaction begins."""

    recording: Recording
    log: Row
    series: tuple[Row, ...]
    is_known_wrong: bool = False
    uploader: str | None = None

    def recording_row(self, row: int, shared: Registry, uploaded_us: int) -> Row:
        """Its row in `recordings`."""
        recording = self.recording
        return {
            "id": row,
            "uuid": recording.id.bytes,
            "digest": bytes.fromhex(recording.digest),
            "recorded_us": microseconds(recording.recorded_at),
            "uploaded_us": uploaded_us,
            "action": recording.action,
            "thing_id": shared.thing(recording.thing),
            "setup_id": shared.setup(recording.setup),
            "gripper": gripper_of(recording),
            "owner": recording.owner,
            "visibility": recording.visibility,
            "ground_truth": bool(recording.ground_truth),
            "words": words(recording),
            "document": recording.document,
            **self.log,
            "seal": seal_of(bytes.fromhex(recording.digest), recording.document),
            "uploaded_by": self.uploader,
            "embargoed_us": None if recording.embargoed_until is None else microseconds(recording.embargoed_until),
            "description_id": shared.description(recording.thing),
        }

    def series_rows(self, row: int, shared: Registry) -> Iterator[Row]:
        """Its rows in `series`."""
        for position, part in enumerate(self.series):
            layout = shared.layout(part["layout"])
            kept = {name: part[name] for name in ("name", "data", "blob")}
            yield {"recording_id": row, "position": position, "layout_id": layout, **kept}

    def file_rows(self, row: int) -> Iterator[Row]:
        """Its rows in `files`."""
        for position, item in enumerate(self.recording.files):
            yield {
                "recording_id": row,
                "position": position,
                "name": item.name,
                "media_type": item.media_type,
                "blob": bytes.fromhex(item.sha256),
            }


def prepare(recording: Recording, blobs: Blobs, *, uploader: str | None = None) -> Prepared:
    """Compress a recording, and put into the blobs what is large: what nothing refers to in the end is only waste."""
    for item in recording.files:
        blobs.put(item.sha256, item.data)
    series = []
    for one in recording.series:
        packed = _placed("data", "blob", pack_series(one), blobs)
        series.append({"name": one.name, "layout": one.layout, **packed})
    log = pack_bytes(recording.log.encode()) if recording.log else None
    return Prepared(recording, _placed("log", "log_blob", log, blobs), tuple(series), uploader=uploader)


def _placed(column: str, blob_column: str, data: bytes | None, blobs: Blobs) -> Row:
    if data is None or len(data) <= IN_ROW_BYTES:
        return {column: data, blob_column: None}
    digest = sha256(data)
    blobs.put(digest.hexdigest(), data)
    return {column: None, blob_column: digest.digest()}


def entry_rows(recording: Recording, head: Mapping[Any, Any]) -> Iterator[Row]:
    """The rows in `entries` of a recording, given its row in `recordings`."""
    shared = {name: head[name] for name in ("thing_id", "setup_id", "gripper", "recorded_us")}
    for position, entry in enumerate(recording.entries):
        yield {"recording_id": head["id"], "position": position, **entry_columns(entry), **shared}


def counted(row: Row, units: Mapping[str, str]) -> Row:
    """The columns of a result, given the units of properties: one of another dimension than its property's counts not.

    It is kept as it was given, and has no value in SI units, as one whose unit nobody stated.
    """
    if row["value_si"] is None or not _is_other(row["property"], row["unit"], units):
        return row
    return {**row, "value_si": None, "sd_si": None}


def has_wrong_unit(recording: Recording, units: Mapping[str, str]) -> bool:
    """Whether a result is in a unit of another dimension than its property's."""
    return any(_is_other(name, unit, units) for _, (name, unit) in units_in(recording))


def _is_other(name: str, unit: str, units: Mapping[str, str]) -> bool:
    return name in units and not are_alike(unit, units[name])


def entry_columns(entry: Entry) -> Row:
    """What the tables hold of an entry; of a number in a unit that is not known here, none in SI units."""
    columns: Row = {"kind": "", "property": entry.property, "value": None, "sd": None, "low": None, "high": None}
    columns |= {"unit": None, "value_si": None, "sd_si": None, "label": None}
    return columns | _own_columns(entry)


def _own_columns(entry: Entry) -> Row:
    if isinstance(entry, Value):
        sd = None if entry.sd is None else float(entry.sd)
        scale = None if entry.unit is None else factor_of(entry.unit)
        # a number of NumPy stays one when it is scaled, and SQLite takes one of 32 bits for bytes
        value = float(entry.value)
        own: Row = {"kind": "value", "value": value, "sd": sd, "unit": entry.unit}
        if scale is not None:
            own |= {"value_si": value * scale, "sd_si": None if sd is None else sd * scale}
        return own
    if isinstance(entry, Distribution):
        return {"kind": "distribution", "label": most_probable(entry.probabilities)}
    if isinstance(entry, Interval):
        return {"kind": "interval", "low": float(entry.low), "high": float(entry.high), "unit": entry.unit}
    if isinstance(entry, Bound):
        low, high = (None if end is None else float(end) for end in (entry.above, entry.below))
        return {"kind": "bound", "low": low, "high": high, "unit": entry.unit}
    return _failed(entry)


def _failed(entry: FailedEntry) -> Row:
    return {"kind": "failed", "property": entry.property}


def most_probable(probabilities: Mapping[str, float]) -> str:
    """The most probable label; where several are, the first in the alphabet.

    Examples
    --------
    >>> most_probable({"mug": 0.4, "box": 0.4, "can": 0.2})
    'box'
    """
    return min(probabilities, key=lambda label: (-probabilities[label], label))


def words(recording: Recording) -> str:
    """What a search by text looks in, in small letters."""
    thing = recording.thing
    named = [recording.action, thing.dataset, thing.id, thing.common_name, thing.maker, *thing.aliases]
    named += [device.name for device in recording.setup.devices] + [recording.owner, *recording.notices]
    return "\n".join(text for text in named if text).casefold()


def gripper_of(recording: Recording) -> str | None:
    """The name of the gripper, if there was one."""
    return None if recording.setup.gripper is None else recording.setup.gripper.name
