"""Reading recordings in parts from the database and the blobs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, Connection, Select, select

from palpate.store import schema
from palpate.store.arrays import unpack_bytes, unpack_series
from palpate.store.blobs import Blobs
from palpate.store.decoding import Stored, recording_from, setup_from
from palpate.store.embargo import embargo_of
from palpate.store.errors import DamagedError, IncompleteError
from palpate.store.legible import legible
from palpate.store.records import Recording, Series, Setup
from palpate.store.registry import thing_of
from palpate.store.remembering import remembered
from palpate.store.seals import checked_document, recording_name

__all__ = [
    "Broken",
    "fetch",
    "from_row_or_blob",
    "id_chunks",
    "parsed_layout",
    "read_each",
    "read_rows",
    "setup_of",
    "whole",
]


@dataclass(frozen=True)
class Broken:
    """A recording that is not what was put: its row number, what it is called, and what is wrong."""

    row: int
    where: str
    what: str

    def __str__(self) -> str:
        return f"{self.where}: {self.what}"


def fetch(connection: Connection, blobs: Blobs, condition: ColumnElement[bool]) -> list[Stored]:
    """The recordings for which a condition on `schema.recordings` holds, in the order in which they came.

    Raises
    ------
    DamagedError
        If bytes are missing or cannot be read.
    """
    recordings, things, setups = schema.recordings, schema.things, schema.setups
    asked = (
        select(recordings, things, setups.c.digest.label("setup_digest"), setups.c.document.label("setup"))
        .join(things, recordings.c.thing_id == things.c.id)
        .join(setups, recordings.c.setup_id == setups.c.id)
        .where(condition)
        .order_by(recordings.c.id)
    )
    rows = connection.execute(asked).mappings().all()
    ids = [row[recordings.c.id] for row in rows]
    series, files = _series(connection, blobs, ids), _files(connection, blobs, ids)
    return [_stored(row, series[row[recordings.c.id]], files[row[recordings.c.id]], blobs) for row in rows]


def whole(stored: Stored) -> Recording:
    """Put a recording together, verified with what it refers to.

    Raises
    ------
    DamagedError
        If it is not what was put into the store.
    """
    recording = recording_from(stored)
    if recording.document != stored.document:
        raise DamagedError(f"recording {stored.id}: refers to another object or setup than its content does")
    return recording


def read_each(connection: Connection, blobs: Blobs, ids: Sequence[int]) -> Iterator[Recording | Broken]:
    """Each recording of these row numbers, or what is wrong with it, in order.

    Raises
    ------
    IncompleteError
        If tables are missing.
    """
    try:
        found = [whole(stored) for stored in fetch(connection, blobs, schema.recordings.c.id.in_(ids))]
        if len(found) < len(ids):
            raise DamagedError("refers to an object or a setup that is missing")
    except IncompleteError:
        raise
    except DamagedError as error:
        if len(ids) == 1:
            where = _name(connection, ids[0])
            yield Broken(ids[0], where, str(error).removeprefix(f"{where}: "))
            return
        # one of them: look at each alone, to name it
        for row in ids:
            yield from read_each(connection, blobs, [row])
        return
    yield from found


def read_rows(
    connection: Connection, asked: Select[*tuple[Any, ...]], ids: Sequence[int]
) -> Iterator[Mapping[Any, Any] | DamagedError]:
    """What is asked for of each recording of these row numbers, or what is wrong with a cell of it, in order.

    Raises
    ------
    IncompleteError
        If tables are missing.
    """
    for row in ids:
        try:
            yield connection.execute(asked.where(schema.recordings.c.id == row)).mappings().one()
        except IncompleteError:
            raise
        except DamagedError as error:
            yield DamagedError(f"{_name(connection, row)}: {error}")


def _name(connection: Connection, row: int) -> str:
    columns = schema.recordings.c
    try:
        return recording_name(connection.execute(select(columns.uuid).where(columns.id == row)).scalar_one())
    except DamagedError:
        return f"recording of row {row}"


def id_chunks(connection: Connection, size: int) -> Iterator[list[int]]:
    """Row numbers of all recordings, some at a time, in the order in which they came."""
    column, last = schema.recordings.c.id, 0
    while ids := list(connection.scalars(select(column).where(column > last).order_by(column).limit(size))):
        yield ids
        last = ids[-1]


def _stored(row: Mapping[Any, Any], series: Sequence[Series], files: Sequence[bytes], blobs: Blobs) -> Stored:
    columns = schema.recordings.c
    with legible(recording_name(row[columns.uuid])):
        return _parts(row, series, files, blobs)


def _parts(row: Mapping[Any, Any], series: Sequence[Series], files: Sequence[bytes], blobs: Blobs) -> Stored:
    columns = schema.recordings.c
    log = from_row_or_blob(row[columns.log], row[columns.log_blob], blobs)
    return Stored(
        id=UUID(bytes=row[columns.uuid]),
        digest=row[columns.digest].hex(),
        visibility=row[columns.visibility],
        embargoed_until=embargo_of(row[columns.embargoed_us]),
        document=row[columns.document],
        log=unpack_bytes(log) if log else b"",
        thing=thing_of({column.name: row[column] for column in schema.things.c}),
        setup=setup_of(row["setup_digest"], row["setup"]),
        series=tuple(series),
        files=tuple(files),
    )


def _series(connection: Connection, blobs: Blobs, ids: Sequence[int]) -> Mapping[int, list[Series]]:
    table, layouts = schema.series, schema.layouts
    asked = (
        select(table.c.recording_id, table.c.name, layouts.c.digest, layouts.c.document, table.c.data, table.c.blob)
        .join(layouts, table.c.layout_id == layouts.c.id)
        .where(table.c.recording_id.in_(ids))
        .order_by(table.c.recording_id, table.c.position)
    )
    found: dict[int, list[Series]] = defaultdict(list)
    for row, name, digest, layout, data, blob in connection.execute(asked):
        packed = from_row_or_blob(data, blob, blobs)
        found[row].append(unpack_series(name, parsed_layout(digest, layout), packed or b""))
    return found


def _files(connection: Connection, blobs: Blobs, ids: Sequence[int]) -> Mapping[int, list[bytes]]:
    table = schema.files.c
    asked = (
        select(table.recording_id, table.blob)
        .where(table.recording_id.in_(ids))
        .order_by(table.recording_id, table.position)
    )
    found: dict[int, list[bytes]] = defaultdict(list)
    for row, blob in connection.execute(asked):
        found[row].append(blobs.get(blob.hex()))
    return found


def from_row_or_blob(data: bytes | None, blob: bytes | None, blobs: Blobs) -> bytes | None:
    """What was small enough for the row, or what the blobs hold in its place."""
    return data if blob is None else blobs.get(blob.hex())


@remembered(1024)
def parsed_layout(digest: bytes, document: str) -> list[dict[str, Any]]:
    """A layout of a series as `palpate.store.arrays.unpack_series` takes it; DamagedError where it is another."""
    layout: list[dict[str, Any]] = checked_document("layouts", digest, document)
    return layout


@remembered(256)
def setup_of(digest: bytes, document: str) -> Setup:
    """The setup of a digest and a document; DamagedError where they do not belong together."""
    return setup_from(checked_document("setups", digest, document))
