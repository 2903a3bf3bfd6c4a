"""Blobs that are missing, damaged, or left over; and who needs them."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, select, union

from palpate.store import schema
from palpate.store.audit import CHANGED
from palpate.store.blobs import Blobs, is_digest
from palpate.store.errors import DamagedError, UnreadableError
from palpate.store.faults import Fault, Remedy
from palpate.store.legible import legible
from palpate.store.seals import recording_name

__all__ = ["blob_faults", "named_blobs", "stray_faults"]

SHOWN = 3


def blob_faults(connection: Connection, blobs: Blobs, lacking: set[int]) -> Iterator[Fault]:
    """Blobs that something refers to and that are missing, damaged or not to be read, with what that is.

    `lacking` gets the row numbers of the recordings that need one of them.
    """
    there, closed, lost = {digest for digest, _ in blobs.all()}, set[str](), dict[str, str]()
    for digest in sorted(named_blobs(connection)):
        try:
            blobs.get(digest)
        except (DamagedError, UnreadableError) as error:
            if isinstance(error, UnreadableError):
                closed.add(digest)
            lost[digest] = str(error).removeprefix(f"blob {digest}: ")
    rows = _rows_with(connection, lost)
    lacking.update(*rows.values())
    for digest, what in lost.items():
        told = f"{what}; needed by {_needed_by(connection, digest, rows[digest])}"
        yield Fault(f"blob {digest}", told, Remedy.SET_ASIDE if digest in there - closed else None)


def stray_faults(connection: Connection, blobs: Blobs, written_before: float) -> Iterator[Fault]:
    """Blobs that nothing refers to and that were written before a time [s since 1970]."""
    named = named_blobs(connection)
    for digest, written in blobs.all():
        if digest not in named and written < written_before:
            yield Fault(f"blob {digest}", "nothing refers to it, and it is older than a day", Remedy.REMOVE)


def named_blobs(connection: Connection) -> set[str]:
    """The digests of all blobs that something refers to.

    Raises
    ------
    DamagedError
        If that cannot be told: then no blob may be removed.
    """
    columns = (schema.series.c.blob, schema.files.c.blob, schema.recordings.c.log_blob, schema.thing_images.c.blob)
    asked = union(*(select(column).where(column.is_not(None)) for column in columns))
    found = {digest.hex() for digest in connection.scalars(asked)}
    return found.union(*(digests for _, digests in _of_audit(connection)))


def _rows_with(connection: Connection, digests: Collection[str]) -> Mapping[str, list[int]]:
    """Row numbers of the recordings that need each of these blobs.

    No index leads to them, so all that refers to a blob is gone through once, however many are lost.
    """
    recordings, series, files = schema.recordings.c, schema.series.c, schema.files.c
    columns = (
        (series.blob, series.recording_id),
        (files.blob, files.recording_id),
        (recordings.log_blob, recordings.id),
    )
    found: dict[str, set[int]] = {digest: set() for digest in digests}
    for blob, row in columns if digests else ():
        for data, number in connection.execute(select(blob, row).where(blob.is_not(None))):
            if data.hex() in found:
                found[data.hex()].add(number)
    return {digest: sorted(rows) for digest, rows in found.items()}


def _needed_by(connection: Connection, digest: str, rows: Sequence[int]) -> str:
    recordings, things, images = schema.recordings.c, schema.things, schema.thing_images.c
    first = select(recordings.uuid).where(recordings.id.in_(rows[:SHOWN])).order_by(recordings.id)
    shown = select(things.c.dataset, things.c.name).join(schema.thing_images, images.thing_id == things.c.id)
    names = [recording_name(uuid) for uuid in connection.scalars(first)]
    shown = shown.where(images.blob == bytes.fromhex(digest))
    names += [f"object {row.dataset}/{row.name}" for row in connection.execute(shown)]
    if not names:
        undone = (f"an undo for object {name}" for name, digests in _of_audit(connection) if digest in digests)
        names = list(dict.fromkeys(undone))
    more = len(names) + len(rows[SHOWN:]) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def _of_audit(connection: Connection) -> Iterator[tuple[str, set[str]]]:
    """The pictures that a change took away or brought: an undo shows them again."""
    audit, things = schema.audit.c, schema.things.c
    asked = (
        select(things.dataset, things.name, audit.detail)
        .join(schema.things, things.id == audit.thing_id)
        .where(audit.what == CHANGED)
    )
    for row in connection.execute(asked):
        name = f"{row.dataset}/{row.name}"
        with legible(f"the audit of object {name}"):
            yield name, set(_images_of(json.loads(row.detail)))


def _images_of(detail: list[dict[str, Any]]) -> Iterator[str]:
    for part in detail:
        if part["field"][0] == "images":
            yield from (part[side][1] for side in ("before", "after") if side in part and is_digest(part[side][1]))
