"""Recordings as rows of an archive's tables, and back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import UUID

from palpate.store.arrays import pack_series, unpack_series
from palpate.store.content import entry_plain, setup_plain, thing_plain, to_json
from palpate.store.decoding import Stored, recording_from, setup_from, thing_from
from palpate.store.entries import Entry
from palpate.store.errors import DamagedError
from palpate.store.filters import digest_bytes
from palpate.store.records import Recording, ThingRef, visibility_now
from palpate.store.rows import entry_columns, gripper_of

if TYPE_CHECKING:
    import pyarrow

__all__ = ["blob_of", "entries_schema", "entry_row", "recording_at", "recording_row", "recordings_schema"]


@cache
def recordings_schema() -> pyarrow.Schema:
    """The columns of ``recordings.parquet``."""
    import pyarrow as pa

    texts = ("id", "digest", "visibility", "action", "dataset", "object", "gripper", "thing", "setup", "document")
    series = pa.struct([("name", pa.string()), ("layout", pa.string()), ("data", pa.binary())])
    columns = [(name, pa.string()) for name in texts]
    columns += [("recorded_at", pa.timestamp("us", tz="UTC")), ("ground_truth", pa.bool_())]
    return pa.schema([*columns, ("series", pa.list_(series)), ("log", pa.binary())])


@cache
def entries_schema() -> pyarrow.Schema:
    """The columns of ``entries.parquet``."""
    import pyarrow as pa

    texts = ("recording", "action", "dataset", "object", "gripper", "kind", "property", "unit", "label", "document")
    numbers = ("value", "sd", "low", "high", "value_si", "sd_si")
    columns = [(name, pa.string()) for name in texts] + [(name, pa.float64()) for name in numbers]
    return pa.schema([*columns, ("recorded_at", pa.timestamp("us", tz="UTC")), ("ground_truth", pa.bool_())])


def recording_row(recording: Recording, said: ThingRef | None = None) -> dict[str, Any]:
    """The row of a recording; `said`: its object, described as it shall be there, where that is otherwise."""
    return {
        **_shared(recording),
        "id": str(recording.id),
        "digest": recording.digest,
        # what else there is of an embargo stands in the manifest, as earlier versions would not heed it
        "visibility": visibility_now(recording.visibility, recording.embargoed_until),
        "thing": to_json(thing_plain(said or recording.thing)),
        "setup": to_json(setup_plain(recording.setup)),
        "document": recording.document,
        "series": [
            {"name": series.name, "layout": series.layout, "data": pack_series(series)} for series in recording.series
        ],
        "log": recording.log.encode(),
    }


def entry_row(recording: Recording, entry: Entry) -> dict[str, Any]:
    """The row of a result."""
    row = {**_shared(recording), **entry_columns(entry)}
    return {**row, "recording": str(recording.id), "document": to_json(entry_plain(entry))}


def recording_at(row: Mapping[str, Any], folder: Path) -> Recording:
    """The recording of a row, verified.

    Raises
    ------
    DamagedError
        If it is not the one of its digest.
    """
    where = f"{folder}: recording {row['id']}"
    try:
        recording = recording_from(_stored(row, folder))
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        if isinstance(error, DamagedError):
            raise
        raise DamagedError(f"{where}: cannot be read ({error}), expected one that palpate wrote") from None
    if recording.document != row["document"]:
        raise DamagedError(f"{where}: is not written as palpate writes it")
    return recording


def _shared(recording: Recording) -> dict[str, Any]:
    return {
        "action": recording.action,
        "dataset": recording.thing.dataset,
        "object": recording.thing.id,
        "gripper": gripper_of(recording),
        "recorded_at": recording.recorded_at,
        "ground_truth": recording.ground_truth,
    }


def _stored(row: Mapping[str, Any], folder: Path) -> Stored:
    document = json.loads(row["document"])
    return Stored(
        id=UUID(row["id"]),
        digest=row["digest"],
        visibility=row["visibility"],
        document=row["document"],
        log=row["log"],
        thing=thing_from(json.loads(row["thing"])),
        setup=setup_from(json.loads(row["setup"])),
        series=tuple(unpack_series(one["name"], json.loads(one["layout"]), one["data"]) for one in row["series"]),
        files=tuple(blob_of(folder, item["sha256"]) for item in document["files"]),
    )


def blob_of(folder: Path, digest: str) -> Path:
    """The file of a digest; nothing else than a digest may name a file."""
    text = digest_bytes(digest).hex()
    path = folder / "blobs" / text[:2] / text[2:]
    if not path.is_file() or path.is_symlink():
        raise DamagedError(f"{folder}: blob {text} is missing")
    return path
