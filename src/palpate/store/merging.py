"""Two objects that are one: merged, and split again; both are noted with who did it.

The merges that hold are a forest, which the audit keeps; each object points to the root of its tree.
"""

from __future__ import annotations

import json
from collections import defaultdict

from sqlalchemy import Connection, select, update

from palpate.store import schema
from palpate.store.audit import MERGED, last_of, note, row_of, take_back
from palpate.store.database import MERGE_LOCK, changing, one_at_a_time
from palpate.store.errors import StoreError
from palpate.store.legible import legible
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
        one_at_a_time(connection, MERGE_LOCK)
        # in the order in which a put takes its objects, so that neither waits for the other
        both = sorted((("thing", thing), ("into", into)), key=lambda named: (named[1].dataset, named[1].id))
        found = {name: row_of(connection, name, ref) for name, ref in both}
        one, other = found["thing"], found["into"]
        for name, row in (("thing", one), ("into", other)):
            if row["merged_into"] is not None:
                raise StoreError(
                    f"{name}: {row['dataset']}/{row['name']} is merged into another, expected one that is not"
                )
        if one["id"] == other["id"]:
            raise StoreError(f"into: {into.dataset}/{into.id} is the same object, expected another one")
        columns = schema.things.c
        taken = list(connection.scalars(select(columns.id).where(columns.merged_into == one["id"])))
        _point(connection, [one["id"], *taken], other["id"])
        note(connection, one["id"], MERGED, {"into": [into.dataset, into.id]}, who)


def split_thing(store: Store, thing: ThingRef, *, who: str | None = None) -> None:
    """Undo `merge_things`: the object, with what was merged into it and still is, is one of its own again.

    Raises
    ------
    StoreError
        If it is not in the store, or not merged.
    """
    with changing(store.engine) as connection:
        one_at_a_time(connection, MERGE_LOCK)
        row = row_of(connection, "thing", thing)
        noted = last_of(connection, row["id"], MERGED)
        if row["merged_into"] is None or noted is None:
            raise StoreError(f"thing: {thing.dataset}/{thing.id} is not merged, expected one that is")
        unmerge(connection, row["id"])
        take_back(connection, noted, who)


def unmerge(connection: Connection, thing: int) -> None:
    """Make an object one of its own again, given its row number, before its merge is noted as taken back."""
    _point(connection, _below(connection, thing), thing)
    _point(connection, [thing], None)


def _below(connection: Connection, thing: int) -> list[int]:
    """What was merged into an object, or into one of those, by merges that hold."""
    things, audit = schema.things, schema.audit
    holds = audit.c.what == MERGED, audit.c.undone_us.is_(None)
    named = select(things.c.id, things.c.dataset, things.c.name)
    rows = {(row.dataset, row.name): row.id for row in connection.execute(named)}
    merged: dict[int, list[int]] = defaultdict(list)
    with legible("the audit of merged objects"):
        for row in connection.execute(select(audit.c.thing_id, audit.c.detail).where(*holds)):
            merged[rows[tuple(json.loads(row.detail)["into"])]].append(row.thing_id)
    found = list(merged[thing])
    # the list grows while it is gone through
    for each in found:
        found += merged[each]
    return found


def _point(connection: Connection, rows: list[int], into: int | None) -> None:
    things = schema.things
    connection.execute(update(things).where(things.c.id.in_(rows)).values(merged_into=into))
