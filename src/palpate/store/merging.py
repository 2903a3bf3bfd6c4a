"""Two objects that are one: merged, and split again; both are noted with who did it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from sqlalchemy import Connection, insert, select, update

from palpate.store import schema
from palpate.store.content import to_json
from palpate.store.database import writing
from palpate.store.errors import StoreError
from palpate.store.records import ThingRef
from palpate.store.registry import now_us
from palpate.store.store import Store

__all__ = ["merge_things", "split_thing"]

MERGED = "merged"


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
    with writing(store.engine).begin() as connection:
        one, other = (_row(connection, name, ref) for name, ref in (("thing", thing), ("into", into)))
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
        detail = {"into": [into.dataset, into.id], "with": taken}
        row = {"at_us": now_us(), "who": who, "what": MERGED, "thing_id": one["id"], "detail": to_json(detail)}
        connection.execute(insert(schema.audit).values(**row))


def split_thing(store: Store, thing: ThingRef) -> None:
    """Undo `merge_things`: the object, with what was merged into it before, is one of its own again.

    Raises
    ------
    StoreError
        If it is not in the store, or not merged.
    """
    with writing(store.engine).begin() as connection:
        row = _row(connection, "thing", thing)
        audit = schema.audit.c
        noted = (audit.thing_id == row["id"], audit.what == MERGED, audit.undone_us.is_(None))
        asked = select(audit.id, audit.detail).where(*noted).order_by(audit.id.desc()).limit(1)
        found = connection.execute(asked).first()
        if row["merged_into"] is None or found is None:
            raise StoreError(f"thing: {thing.dataset} {thing.id} is not merged, expected one that is")
        columns = schema.things.c
        # what was split off meanwhile stays so
        still = columns.id.in_(json.loads(found.detail)["with"]), columns.merged_into == row["merged_into"]
        _point(connection, list(connection.scalars(select(columns.id).where(*still))), row["id"])
        _point(connection, [row["id"]], None)
        connection.execute(update(schema.audit).where(audit.id == found.id).values(undone_us=now_us()))


def _row(connection: Connection, name: str, thing: ThingRef) -> Mapping[Any, Any]:
    columns = schema.things.c
    asked = select(schema.things).where(columns.dataset == thing.dataset, columns.name == thing.id)
    row = connection.execute(asked).mappings().first()
    if row is None:
        raise StoreError(f"{name}: {thing.dataset} {thing.id} is not in the store, expected an object that is")
    return row


def _point(connection: Connection, rows: list[int], into: int | None) -> None:
    things = schema.things
    connection.execute(update(things).where(things.c.id.in_(rows)).values(merged_into=into))
