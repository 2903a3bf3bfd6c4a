"""Whether all that a store holds is whole, and what can be mended without a risk."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from uuid import UUID

from sqlalchemy import Connection, inspect, select, text

from palpate.store import schema
from palpate.store.blobs import Blobs
from palpate.store.errors import DamagedError
from palpate.store.faults import Fault, Remedy
from palpate.store.legible import reading
from palpate.store.seals import checked_document
from palpate.store.store import Store
from palpate.store.verifying_blobs import blob_faults, named_blobs, stray_faults
from palpate.store.verifying_episodes import episode_faults, known_faults, mend_episode
from palpate.store.verifying_recordings import mend_recording, recording_faults

__all__ = ["repair", "verify"]

YOUNG_S = 24 * 3600.0
"""Blobs younger than this may belong to a recording that is just being put."""


def verify(store: Store) -> Iterator[Fault]:
    """Check every digest and every reference, and give each fault found.

    What cannot be looked at is a fault too, and does not hold up the rest. A recording whose blob is lost is named with
    the blob, and once it is back another look may find more.
    """
    lacking = set[int]()
    yield from _part(store, "the database", _database_faults)
    yield from _part(store, "setups, devices and layouts", _shared_faults)
    yield from _part(store, "blobs", lambda connection: blob_faults(connection, store.blobs, lacking))
    yield from _part(store, "recordings", lambda connection: recording_faults(connection, store, lacking))
    yield from _part(store, "episodes", episode_faults)
    yield from _part(store, "what is known of objects", known_faults)
    yield from _part(
        store, "old blobs", lambda connection: stray_faults(connection, store.blobs, time.time() - YOUNG_S)
    )


def repair(store: Store) -> list[Fault]:
    """Verify, and take the safe steps: see `Remedy`.

    Rows that queries use are made again from recordings whose digest is right; damaged blobs are set aside, so that
    putting or importing the recording again brings them back; old blobs that nothing refers to are removed. No
    recording is changed or removed.

    Returns
    -------
    list of Fault
        All faults that were found; `Fault.done` tells which steps were taken.
    """
    faults = list(verify(store))
    strays = any(fault.remedy is Remedy.REMOVE for fault in faults)
    # looked up again: verifying takes its time, and somebody may have put what needs them meanwhile
    with reading(store.engine) as connection:
        needed = named_blobs(connection) if strays else set()
    return [replace(fault, done=_mend(store, fault, needed)) for fault in faults]


def _mend(store: Store, fault: Fault, needed: set[str]) -> bool:
    """Take the safe step, if there is one and it is still safe."""
    kind, _, name = fault.where.partition(" ")
    if fault.remedy is Remedy.REINDEX and kind == "episode":
        mend_episode(store, UUID(name))
    elif fault.remedy is Remedy.REINDEX:
        mend_recording(store, UUID(name))
    elif fault.remedy is Remedy.SET_ASIDE:
        return _set_aside(store.blobs, name)
    elif fault.remedy is Remedy.REMOVE:
        return name not in needed and store.blobs.remove(name, time.time() - YOUNG_S)
    return fault.remedy is not None


def _set_aside(blobs: Blobs, digest: str) -> bool:
    """Set a blob aside, unless somebody has put the right one in its place meanwhile."""
    try:
        blobs.get(digest)
    except DamagedError:
        blobs.set_aside(digest)
        return True
    return False


def _part(store: Store, name: str, look: Callable[[Connection], Iterator[Fault]]) -> Iterator[Fault]:
    """The faults of a part of the store, and that it could not be looked at to its end."""
    try:
        with reading(store.engine) as connection:
            yield from look(connection)
    except DamagedError as error:
        yield Fault("database", f"{name} could not all be checked: {error}")


def _database_faults(connection: Connection) -> Iterator[Fault]:
    there = set(inspect(connection).get_table_names())
    for name in schema.metadata.tables:
        if name not in there:
            yield Fault("database", f"the table {name} is missing")
    if connection.dialect.name != "sqlite":
        return
    for (line,) in connection.execute(text("PRAGMA integrity_check")):
        if line != "ok":
            yield Fault("database", str(line))
    for table, row, parent, _ in connection.execute(text("PRAGMA foreign_key_check")):
        yield Fault("database", f"row {row} of {table} refers to a row of {parent} that is missing")


def _shared_faults(connection: Connection) -> Iterator[Fault]:
    """Setups, devices and layouts whose digest is not that of their document."""
    for table in (schema.setups, schema.devices, schema.layouts):
        for digest, document in connection.execute(select(table.c.digest, table.c.document)):
            try:
                checked_document(table.name, digest, document)
            except DamagedError as error:
                yield Fault(f"{table.name} {digest.hex()}", str(error).partition(": ")[2])
