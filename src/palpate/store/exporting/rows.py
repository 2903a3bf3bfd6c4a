"""Recordings as rows of the tables of an export."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Connection, select

from palpate.store import schema
from palpate.store.content import canonical_dtype, device_plain, to_json
from palpate.store.entries import Distribution, FailedEntry
from palpate.store.exporting.census import Census
from palpate.store.exporting.columns import AUDIOS, CHANNELS, ENTRIES, FILES, IMAGES, RECORDINGS, Table
from palpate.store.records import Channel, FileItem, Pose, Recording, visibility_now
from palpate.store.rows import counted, entry_columns, gripper_of

__all__ = ["object_rows", "rows_of", "setup_rows"]

Row = dict[str, Any]


def rows_of(recordings: Sequence[Recording], units: Mapping[str, str]) -> Mapping[Table, list[Row]]:
    """The rows of recordings in each table that is about recordings, given the units of the store's properties."""
    found: dict[Table, list[Row]] = {table: [] for table in (RECORDINGS, ENTRIES, CHANNELS, IMAGES, AUDIOS, FILES)}
    for recording in recordings:
        found[RECORDINGS].append(_recording_row(recording))
        found[ENTRIES] += (counted(row, units) for row in _entry_rows(recording))
        found[CHANNELS] += _channel_rows(recording)
        for item in recording.files:
            table, row = _file_row(item)
            found[table].append({"recording": str(recording.id), **row})
    return found


def object_rows(census: Census, connection: Connection) -> Iterator[Row]:
    """The rows of all objects that were counted."""
    heads = _heads(connection)
    for key, thing in sorted(census.things.items()):
        same_dataset, same_name = heads.get(key, (None, None))
        yield {
            "dataset": thing.dataset,
            "object": thing.id,
            "maker": thing.maker,
            "common_name": thing.common_name,
            "aliases": list(thing.aliases),
            "attributes_json": to_json(thing.attributes),
            "same_as_dataset": same_dataset,
            "same_as_object": same_name,
        }


def setup_rows(census: Census) -> Iterator[Row]:
    """The rows of all setups that were counted, one for each device."""
    for digest, setup in sorted(census.setups.items()):
        for device in setup.devices:
            plain = device_plain(device) or {}
            yield {
                "setup": digest,
                "kind": device.kind,
                "device": device.name,
                "maker": device.maker,
                "calibrated_on": device.calibrated_on,
                "parameters_json": to_json(plain["parameters"]),
                "calibration_json": to_json(plain["calibration"]),
            }


def _heads(connection: Connection) -> Mapping[tuple[str, str], tuple[str, str]]:
    """Objects that were merged into another, with that one."""
    part, head = schema.things.alias(), schema.things.alias()
    asked = select(part.c.dataset, part.c.name, head.c.dataset, head.c.name).join(head, part.c.merged_into == head.c.id)
    return {(row[0], row[1]): (row[2], row[3]) for row in connection.execute(asked)}


def _shared(recording: Recording) -> Row:
    return {
        "recording": str(recording.id),
        "recorded_at": recording.recorded_at,
        "action": recording.action,
        "dataset": recording.thing.dataset,
        "object": recording.thing.id,
        "gripper": gripper_of(recording),
        "ground_truth": bool(recording.ground_truth),
    }


def _recording_row(recording: Recording) -> Row:
    same = ("digest", "owner", "licence", "software", "repository", "log")
    return {
        **_shared(recording),
        **{name: getattr(recording, name) for name in same},
        "visibility": visibility_now(recording.visibility, recording.embargoed_until),
        "common_name": recording.thing.common_name,
        "setup": recording.setup.digest,
        "grasp_json": None if recording.grasp is None else to_json(recording.grasp),
        **_pose_columns("gripper", recording.gripper_pose),
        **_pose_columns("object", recording.object_pose),
        "notices": list(recording.notices),
    }


def _pose_columns(name: str, pose: Pose | None) -> Row:
    if pose is None:
        return {}
    return {
        f"{name}_position_m": list(pose.translation_m),
        f"{name}_quaternion": None if pose.quaternion is None else list(pose.quaternion),
        f"{name}_frame": pose.frame,
        f"{name}_pose_json": to_json(pose.original),
    }


def _entry_rows(recording: Recording) -> Iterator[Row]:
    shared = _shared(recording)
    for position, entry in enumerate(recording.entries):
        row = {**shared, "position": position, **entry_columns(entry)}
        if isinstance(entry, Distribution):
            row |= {"labels": list(entry.probabilities), "probabilities": list(entry.probabilities.values())}
        if isinstance(entry, FailedEntry):
            row["reason"] = entry.reason
        yield row


def _channel_rows(recording: Recording) -> Iterable[Row]:
    for series in recording.series:
        for channel in series.channels:
            yield {"recording": str(recording.id), "series": series.name, **_channel_columns(channel)}


def _channel_columns(channel: Channel) -> Row:
    return {
        "channel": channel.name,
        "quantity": channel.quantity,
        "unit": channel.unit,
        "rate_hz": channel.rate_hz,
        "time_s": channel.time_s,
        "values": np.asarray(channel.values, dtype=np.float64).ravel(),
        "sample_shape": list(channel.values.shape[1:]),
        "dtype": canonical_dtype(channel.values.dtype).str,
    }


def _file_row(item: FileItem) -> tuple[Table, Row]:
    data = item.data.read_bytes() if isinstance(item.data, Path) else item.data
    row: Row = {"name": item.name, "media_type": item.media_type, "sha256": item.sha256}
    embedded = {"bytes": data, "path": item.name.rpartition("/")[2]}
    match item.media_type.partition("/")[0].strip().casefold():
        case "image":
            return IMAGES, {**row, "image": embedded}
        case "audio":
            return AUDIOS, {**row, "audio": embedded}
        case _:
            return FILES, {**row, "data": data}
