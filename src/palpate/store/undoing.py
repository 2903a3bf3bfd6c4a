"""Taking back the last change of an object."""

from __future__ import annotations

import json
from typing import Any

from sqlalchemy import ColumnElement, Connection

from palpate.store.audit import MERGED, UNDOABLE, Change, change_of, last_of, row_of, take_back
from palpate.store.content import to_json
from palpate.store.database import MERGE_LOCK, changing, one_at_a_time
from palpate.store.describing import admit_known, fields_of, with_fields, write
from palpate.store.errors import StoreError
from palpate.store.legible import legible
from palpate.store.merging import unmerge
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import is_thing, things_where

__all__ = ["undo"]


def undo(store: Store, thing: ThingRef, *, who: str | None = None, among: ColumnElement[bool] | None = None) -> Change:
    """Take back the last change of an object that holds: of its description, or that it was merged.

    Called again it takes back the one before.

    Parameters
    ----------
    store
        Where it is.
    thing
        The object, by dataset and id.
    who
        Who decided it, for the audit.
    among
        A condition on `schema.audit` as to which changes may be taken back; all unless given.

    Returns
    -------
    Change
        What was taken back.

    Raises
    ------
    StoreError
        If it is not in the store, nothing is left to take back, or what was changed is no longer as it was left: a
        recording has completed the description since, or a change that is not among these has changed it, or what was
        known is in a unit that was taken back.
    """
    with changing(store.engine) as connection:
        one_at_a_time(connection, MERGE_LOCK)
        row = row_of(connection, "thing", thing)
        last = last_of(connection, row["id"], *UNDOABLE, among=among)
        if last is None:
            raise StoreError(f"thing: {thing.dataset}/{thing.id} has no change to take back, expected one that has")
        if last["what"] == MERGED:
            unmerge(connection, row["id"])
        else:
            with legible(f"the audit of object {thing.dataset}/{thing.id}"):
                _restore(connection, row["id"], thing, json.loads(last["detail"]))
        take_back(connection, last, who)
        return change_of(connection, last["id"])


def _restore(connection: Connection, row: int, thing: ThingRef, detail: list[dict[str, Any]]) -> None:
    (now,) = things_where(connection, is_thing(thing))
    fields = dict(fields_of(now))
    # what was only taken away from those who hear it is not noted with what was there, and shows again by itself
    for one in (one for one in detail if "before" in one or "after" in one):
        field = tuple(one["field"])
        if to_json(fields.get(field)) != to_json(one.get("after")):
            where = f"thing: {thing.dataset}/{thing.id}: {'.'.join(field)}"
            raise StoreError(
                f"{where} was completed since by a recording, or changed, expected what the change left: set it"
            )
        fields.pop(field, None)
        if "before" in one:
            fields[field] = one["before"]
    restored = with_fields(now, fields)
    try:
        # the unit of a property may have been taken back since
        admit_known(connection, now, restored)
    except StoreError as error:
        raise StoreError(f"thing: {thing.dataset} {thing.id}: {error}: tell it anew") from None
    write(connection, row, restored)
