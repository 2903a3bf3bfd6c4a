"""Two objects that are one: merged, and split again; both are noted with who did it."""

from __future__ import annotations

import json

from sqlalchemy import Connection, select, update

from palpate.store import schema
from palpate.store.audit import MERGED, Row, last_of, note, row_of, take_back
from palpate.store.database import changing
from palpate.store.errors import StoreError
from palpate.store.records import ThingRef
from palpate.store.store import Store

__all__ = ["merge_things", "split_thing"]


def merge_things(store: Store, thing: ThingRef, into: ThingRef, *, who: str | None = None) -> None:
    """Count what was measured of an object as measured of another one.

    No recording is changed: questions about the second also give the recordings of the first, until it is split off
    again by `split_thing`. What was merged into the first goes with it.

    Parameters
    ----------
    store
        Where both are.
    thing, into
        The two objects, by dataset and id.
    who
        Who decided it, for the audit.

    Raises
    ------
    StoreError
        If one is not in the store, is merged already, or both are the same.
    """
    with changing(store.engine) as connection:
        one, other = (row_of(connection, name, ref) for name, ref in (("thing", thing), ("into", into)))
        for name, row in (("thing", one), ("into", other)):
            if row["merged_into"] is not None:
                raise StoreError(
                    f"{name}: {row['dataset']} {row['name']} is merged into another, expected one that is not"
                )
        if one["id"] == other["id"]:
            raise StoreError(f"into: {into.dataset} {into.id} is the same object, expected another one")
        columns = schema.things.c
        taken = list(connection.scalars(select(columns.id).where(columns.merged_into == one["id"])))
        _point(connection, [one["id"], *taken], other["id"])
        note(connection, one["id"], MERGED, {"into": [into.dataset, into.id], "with": taken}, who)


def split_thing(store: Store, thing: ThingRef, *, who: str | None = None) -> None:
    """Undo `merge_things`: the object, with what was merged into it before, is one of its own again.

    Raises
    ------
    StoreError
        If it is not in the store, or not merged.
    """
    with changing(store.engine) as connection:
        row = row_of(connection, "thing", thing)
        noted = last_of(connection, row["id"], MERGED)
        if row["merged_into"] is None or noted is None:
            raise StoreError(f"thing: {thing.dataset} {thing.id} is not merged, expected one that is")
        unmerge(connection, row, noted)
        take_back(connection, noted, who)


def unmerge(connection: Connection, row: Row, noted: Row) -> None:
    """Make an object one of its own again, given its row and what the audit says of its merge."""
    columns = schema.things.c
    # what was split off meanwhile stays so
    still = columns.id.in_(json.loads(noted["detail"])["with"]), columns.merged_into == row["merged_into"]
    _point(connection, list(connection.scalars(select(columns.id).where(*still))), row["id"])
    _point(connection, [row["id"]], None)


def _point(connection: Connection, rows: list[int], into: int | None) -> None:
    things = schema.things
    connection.execute(update(things).where(things.c.id.in_(rows)).values(merged_into=into))
