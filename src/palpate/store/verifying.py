"""Whether all that a store holds is whole, and what can be mended without a risk."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Select, delete, insert, select, text, union, update

from palpate.store import schema
from palpate.store.database import writing
from palpate.store.decoding import Stored, recording_from
from palpate.store.errors import DamagedError
from palpate.store.fetching import fetch, id_chunks
from palpate.store.records import Recording
from palpate.store.rows import counted, entry_rows, gripper_of, microseconds
from palpate.store.store import Store
from palpate.store.units import deciding_units
from palpate.store.verifying_episodes import episode_faults, known_faults, mend_episode

__all__ = ["Fault", "repair", "verify"]

AT_ONCE = 200
YOUNG_S = 24 * 3600.0
"""Blobs younger than this may belong to a recording that is just being put."""


@dataclass(frozen=True)
class Fault:
    """Something that is not as it was written.

    Attributes
    ----------
    where
        ``recording ...``, ``episode ...``, ``object ...``, ``blob ...``, ``setup ...`` or ``database``.
    what
        What was found.
    remedy
        What `repair` does about it; None where nothing is safe.
    """

    where: str
    what: str
    remedy: str | None = None


def verify(store: Store) -> Iterator[Fault]:
    """Check every digest and every reference, and give each fault found."""
    with store.engine.connect() as connection:
        yield from _database_faults(connection)
        yield from _shared_faults(connection)
        for ids in id_chunks(connection, AT_ONCE):
            yield from _recording_faults(connection, store, ids)
        for where, what, again in (*episode_faults(connection), *known_faults(connection)):
            yield Fault(where, what, REINDEX if again else None)
        yield from _blob_faults(connection, store)


def repair(store: Store) -> list[Fault]:
    """Verify, and take the safe steps: see `Fault.remedy`.

    Rows that queries use are made again from recordings whose digest is right; damaged blobs are set aside, so that
    putting the recording again brings them back; old blobs that nothing refers to are removed. No recording is
    changed or removed.

    Returns
    -------
    list of Fault
        All faults that were found, mended or not.
    """
    faults = list(verify(store))
    for fault in faults:
        kind, _, name = fault.where.partition(" ")
        if fault.remedy == REINDEX and kind == "episode":
            mend_episode(store, UUID(name))
        elif fault.remedy == REINDEX:
            _reindex(store, UUID(name))
        elif fault.remedy == SET_ASIDE:
            store.blobs.set_aside(name)
        elif fault.remedy == REMOVE:
            store.blobs.remove(name)
    return faults


REINDEX = "make the rows for queries again"
SET_ASIDE = "set aside, so that putting the recording again restores it"
REMOVE = "remove"


def _database_faults(connection: Connection) -> Iterator[Fault]:
    if connection.dialect.name != "sqlite":
        return
    try:
        for (line,) in connection.execute(text("PRAGMA integrity_check")):
            if line != "ok":
                yield Fault("database", str(line))
    except DamagedError as error:
        yield Fault("database", str(error))
    for table, row, parent, _ in connection.execute(text("PRAGMA foreign_key_check")):
        yield Fault("database", f"row {row} of {table} refers to a row of {parent} that is missing")


def _shared_faults(connection: Connection) -> Iterator[Fault]:
    """Setups, devices and layouts whose digest is not that of their document."""
    for table in (schema.setups, schema.devices, schema.layouts):
        for digest, document in connection.execute(select(table.c.digest, table.c.document)):
            if sha256(document.encode()).digest() != digest:
                yield Fault(f"{table.name} {digest.hex()}", "its content is not the one of its digest")


def _recording_faults(connection: Connection, store: Store, ids: Sequence[int]) -> Iterator[Fault]:
    columns = schema.recordings.c
    try:
        found = fetch(connection, store.blobs, columns.id.in_(ids))
    except DamagedError as error:
        if len(ids) == 1:
            uuid = connection.execute(select(columns.uuid).where(columns.id == ids[0])).scalar_one()
            yield Fault(f"recording {UUID(bytes=uuid)}", str(error))
            return
        # one of them: look at each alone, to name it
        for row in ids:
            yield from _recording_faults(connection, store, [row])
        return
    there, units = _entries_there(connection, ids), deciding_units(connection)
    heads = {head["id"]: head for head in connection.execute(_heads(ids)).mappings()}
    for row, stored in zip(ids, found, strict=True):
        yield from _stored_faults(stored, heads[row], there[row], units)


def _stored_faults(
    stored: Stored, head: Mapping[Any, Any], entries: Sequence[Mapping[str, Any]], units: Mapping[str, str]
) -> Iterator[Fault]:
    where = f"recording {stored.id}"
    try:
        recording = recording_from(stored)
    except DamagedError as error:
        yield Fault(where, str(error))
        return
    if recording.document != stored.document:
        yield Fault(where, "refers to another object or setup than its content does")
    elif dict(head) != {**head, **_head_wanted(recording)} or list(entries) != _entries_wanted(recording, head, units):
        yield Fault(where, "rows for queries are not those of its content", REINDEX)


def _heads(ids: Sequence[int]) -> Select[*tuple[Any, ...]]:
    names = ("id", "thing_id", "setup_id", "gripper", "recorded_us", "action", "owner", "ground_truth")
    return select(*(schema.recordings.c[name] for name in names)).where(schema.recordings.c.id.in_(ids))


def _head_wanted(recording: Recording) -> dict[str, Any]:
    """What the columns of a recording repeat of its content."""
    return {
        "gripper": gripper_of(recording),
        "recorded_us": microseconds(recording.recorded_at),
        "action": recording.action,
        "owner": recording.owner,
        "ground_truth": recording.ground_truth,
    }


def _entries_wanted(recording: Recording, head: Mapping[Any, Any], units: Mapping[str, str]) -> list[dict[str, Any]]:
    return [counted(row, units) for row in entry_rows(recording, {**head, **_head_wanted(recording)})]


def _entries_there(connection: Connection, ids: Sequence[int]) -> Mapping[int, list[dict[str, Any]]]:
    table = schema.entries
    found: dict[int, list[dict[str, Any]]] = defaultdict(list)
    asked = select(table).where(table.c.recording_id.in_(ids)).order_by(table.c.recording_id, table.c.position)
    for row in connection.execute(asked).mappings():
        found[row["recording_id"]].append(dict(row))
    return found


def _reindex(store: Store, key: UUID) -> None:
    """Make the rows that queries use again."""
    recording, columns = store.get(key), schema.recordings.c
    with writing(store.engine).begin() as connection:
        row = connection.execute(select(columns.id).where(columns.uuid == key.bytes)).scalar_one()
        head = connection.execute(_heads([row])).mappings().one()
        connection.execute(update(schema.recordings).where(columns.id == row).values(**_head_wanted(recording)))
        connection.execute(delete(schema.entries).where(schema.entries.c.recording_id == row))
        entries = _entries_wanted(recording, head, deciding_units(connection))
        if entries:
            connection.execute(insert(schema.entries), entries)


def _blob_faults(connection: Connection, store: Store) -> Iterator[Fault]:
    """Blobs that are missing, damaged or referred to by nothing."""
    columns = [schema.series.c.blob, schema.files.c.blob, schema.recordings.c.log_blob, schema.thing_images.c.blob]
    asked = union(*(select(column).where(column.is_not(None)) for column in columns))
    wanted = {digest.hex() for digest in connection.scalars(asked)}
    there = dict(store.blobs.all())
    for digest in sorted(wanted):
        try:
            store.blobs.get(digest)
        except DamagedError as error:
            yield Fault(f"blob {digest}", str(error), SET_ASIDE if digest in there else None)
    for digest, written in there.items():
        if digest not in wanted and written < time.time() - YOUNG_S:
            yield Fault(f"blob {digest}", "nothing refers to it", REMOVE)
