"""A recording in parts, for somebody who may see it: what was measured without the signals, one series, one file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from math import prod
from typing import Any
from uuid import UUID

import numpy as np
from sqlalchemy import ColumnElement, Connection, select

from palpate.store import schema
from palpate.store.arrays import unpack_bytes, unpack_series
from palpate.store.decoding import entry_from, moment_from, pose_from
from palpate.store.embargo import embargo_of
from palpate.store.entries import Entry
from palpate.store.fetching import from_row_or_blob, parsed_layout, setup_of
from palpate.store.implausible import faults_of
from palpate.store.legible import reading
from palpate.store.records import Pose, Series, Setup, ThingRef, visibility_now
from palpate.store.registry import thing_of
from palpate.store.rows import moment_at
from palpate.store.seals import sealed_document
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_words import seen_refs

__all__ = ["Head", "SeriesInfo", "StoredFile", "head_of", "log_of", "series_of"]

TIME_BYTES = 8


@dataclass(frozen=True)
class SeriesInfo:
    """A series without its samples: for each channel its name, quantity, unit, rate and number of samples."""

    name: str
    channels: tuple[Mapping[str, Any], ...]

    @property
    def numbers(self) -> int:
        """How many numbers its samples and time stamps have, whatever the shape of a sample."""
        return sum(values + times for values, times, _ in self._counts())

    @property
    def size_bytes(self) -> int:
        """How many bytes these take when they are read."""
        return sum(values * each_bytes + times * TIME_BYTES for values, times, each_bytes in self._counts())

    def _counts(self) -> Iterator[tuple[int, int, int]]:
        """Numbers of the samples, time stamps, and bytes of a number, of each channel."""
        for one in self.channels:
            times = one["count"] if one["timed"] else 0
            yield one["count"] * prod(one["shape"]), times, np.dtype(one["dtype"]).itemsize


@dataclass(frozen=True)
class StoredFile:
    """A file of a recording; its bytes are in the blobs under their SHA-256."""

    name: str
    media_type: str
    sha256: str


@dataclass(frozen=True)
class Head:
    """All of a recording but samples, what is in its files, and its log."""

    row: int
    id: UUID
    digest: str
    uploaded_at: datetime
    visibility: str
    thing: ThingRef
    setup: Setup
    series: tuple[SeriesInfo, ...]
    files: tuple[StoredFile, ...]
    document: Mapping[str, Any]
    uploaded_by: str | None
    embargoed_until: datetime | None

    @property
    def recorded_at(self) -> datetime:
        """When it was recorded."""
        return moment_from(self.document["recorded_at"])

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The results."""
        return tuple(map(entry_from, self.document["entries"]))

    @property
    def implausible(self) -> tuple[str, ...]:
        """Which results cannot be true."""
        return faults_of(self.entries)

    def pose(self, name: str) -> Pose | None:
        """``gripper_pose`` or ``object_pose``."""
        return pose_from(self.document[name])


def head_of(store: Store, viewer: Viewer, key: UUID | bytes) -> Head | None:
    """The recording of an id or a digest without its signals, or None where there is none to see."""
    recordings, things, setups = schema.recordings, schema.things, schema.setups
    column = recordings.c.uuid if isinstance(key, UUID) else recordings.c.digest
    asked = (
        select(recordings, things, setups.c.digest.label("setup_digest"), setups.c.document.label("setup"))
        .join(things, things.c.id == recordings.c.thing_id)
        .join(setups, setups.c.id == recordings.c.setup_id)
        .where(column == (key.bytes if isinstance(key, UUID) else key), viewer.of(recordings))
    )
    with reading(store.engine) as connection:
        row = connection.execute(asked).mappings().first()
        if row is None:
            return None
        head, key_of = _as_sent(connection, viewer, _head(row)), row[things.c.id]
        return replace(head, thing=seen_refs(connection, viewer, {key_of: head.thing})[key_of])


def _as_sent(connection: Connection, viewer: Viewer, head: Head) -> Head:
    """What is hidden from others, to one of several who have sent it: as if it were sent by them alone."""
    mine = viewer.name in (head.document["owner"], head.uploaded_by)
    if viewer.everything or mine or visibility_now(head.visibility, head.embargoed_until) != "private":
        return head
    senders = schema.senders.c
    asked = select(senders.sent_us).where(senders.name == viewer.name, senders.recording_id == head.row)
    sent_us = connection.scalar(asked)
    if sent_us is None:
        return head
    return replace(head, uploaded_by=viewer.name, uploaded_at=moment_at(sent_us))


def _head(row: Mapping[Any, Any]) -> Head:
    columns = schema.recordings.c
    same = {name: row[columns[name]] for name in ("uuid", "digest", "document", "seal")}
    named = {name: row[schema.things.c[name]] for name in ("dataset", "name")}
    plain = sealed_document({**same, **named})
    return Head(
        row=row[columns.id],
        id=UUID(bytes=row[columns.uuid]),
        digest=row[columns.digest].hex(),
        uploaded_at=moment_at(row[columns.uploaded_us]),
        visibility=row[columns.visibility],
        thing=thing_of({column.name: row[column] for column in schema.things.c}),
        setup=setup_of(row["setup_digest"], row["setup"]),
        series=tuple(SeriesInfo(one["name"], _channels(one)) for one in plain["series"]),
        files=tuple(StoredFile(one["name"], one["media_type"], one["sha256"]) for one in plain["files"]),
        document=plain,
        uploaded_by=row[columns.uploaded_by],
        embargoed_until=embargo_of(row[columns.embargoed_us]),
    )


def _channels(series: Mapping[str, Any]) -> tuple[Mapping[str, Any], ...]:
    pairs = zip(series["channels"], series["counts"], strict=True)
    return tuple({**channel, "count": count} for channel, count in pairs)


def series_of(store: Store, head: Head, position: int) -> Series | None:
    """One series with its samples; None where there is none at that position.

    Raises
    ------
    DamagedError
        If what is stored is not what was put.
    """
    table, layouts = schema.series, schema.layouts
    asked = (
        select(table.c.name, layouts.c.digest, layouts.c.document, table.c.data, table.c.blob)
        .join(layouts, table.c.layout_id == layouts.c.id)
        .where(_at(table.c.recording_id, head, table.c.position, position))
    )
    with reading(store.engine) as connection:
        row = connection.execute(asked).first()
        if row is None:
            return None
        packed = from_row_or_blob(row.data, row.blob, store.blobs) or b""
        return unpack_series(row.name, parsed_layout(row.digest, row.document), packed)


def log_of(store: Store, head: Head) -> str:
    """What the program printed."""
    columns = schema.recordings.c
    with reading(store.engine) as connection:
        row = connection.execute(select(columns.log, columns.log_blob).where(columns.id == head.row)).one()
    packed = from_row_or_blob(row.log, row.log_blob, store.blobs)
    return unpack_bytes(packed).decode() if packed else ""


def _at(key: ColumnElement[int], head: Head, place: ColumnElement[int], position: int) -> ColumnElement[bool]:
    return (key == head.row) & (place == position)
