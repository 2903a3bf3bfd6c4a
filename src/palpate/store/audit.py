"""Who changed what about an object, and when; each change says what was there before."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, insert, select, update

from palpate.store import schema
from palpate.store.completing import ADDED, CHANGED
from palpate.store.content import to_json
from palpate.store.decoding import entry_from
from palpate.store.errors import StoreError
from palpate.store.legible import legible, reading
from palpate.store.records import ThingRef
from palpate.store.registry import now_us, thing_of
from palpate.store.rows import moment_at
from palpate.store.store import Store
from palpate.store.things import is_thing

__all__ = ["ADDED", "CHANGED", "MERGED", "UNDOABLE", "Change", "history"]

MERGED = "merged"
UNDOABLE = (CHANGED, MERGED)
Row = Mapping[Any, Any]


@dataclass(frozen=True)
class Change:
    """A line of the audit.

    Attributes
    ----------
    at, who
        When it was done, and by whom; None where nobody said so.
    what
        ``added``, ``changed``, ``merged`` or ``described otherwise``: a recording contradicts the description.
    thing
        The object.
    detail
        What was there before and after.
    undone_at, undone_by
        When it was taken back, and by whom; None where it holds.
    """

    at: datetime
    who: str | None
    what: str
    thing: ThingRef
    detail: Any
    undone_at: datetime | None
    undone_by: str | None


def history(
    store: Store, thing: ThingRef | None = None, condition: ColumnElement[bool] | None = None
) -> tuple[Change, ...]:
    """What was changed about an object, or about all, the first first; `condition`: on `schema.audit`, as to which."""
    asked = _lines() if condition is None else _lines().where(condition)
    asked = asked.order_by(schema.audit.c.id)
    if thing is not None:
        asked = asked.where(is_thing(thing))
    with reading(store.engine) as connection:
        return tuple(_change(row) for row in connection.execute(asked).mappings())


def note(connection: Connection, thing_id: int | None, what: str, detail: Any, who: str | None, **others: int) -> None:
    """Add a line, in the transaction of the change itself; `others` are rows that it is about beside an object."""
    row = {"at_us": now_us(), "who": who, "what": what, "thing_id": thing_id, "detail": to_json(detail), **others}
    connection.execute(insert(schema.audit).values(**row))


def last_of(connection: Connection, thing_id: int, *what: str, among: ColumnElement[bool] | None = None) -> Row | None:
    """The last change of these kinds that was not taken back; `among`: on `schema.audit`, as to which."""
    audit = schema.audit
    holds = (audit.c.thing_id == thing_id, audit.c.what.in_(what), audit.c.undone_us.is_(None))
    asked = select(audit).where(*holds) if among is None else select(audit).where(*holds, among)
    return connection.execute(asked.order_by(audit.c.id.desc()).limit(1)).mappings().first()


def change_of(connection: Connection, line: int) -> Change:
    """A line of the audit by its row number."""
    return _change(connection.execute(_lines().where(schema.audit.c.id == line)).mappings().one())


def take_back(connection: Connection, row: Row, who: str | None) -> None:
    """Note that a change was undone."""
    audit = schema.audit
    connection.execute(update(audit).where(audit.c.id == row["id"]).values(undone_us=now_us(), undone_by=who))


def row_of(connection: Connection, name: str, thing: ThingRef) -> Row:
    """The row of an object, which nobody else changes until the transaction ends; StoreError where there is none."""
    # what refers to it may be put meanwhile
    asked = select(schema.things).where(is_thing(thing)).with_for_update(key_share=True)
    row = connection.execute(asked).mappings().first()
    if row is None:
        raise StoreError(f"{name}: {thing.dataset}/{thing.id} is not in the store, expected an object that is")
    return row


def _lines() -> Select[*tuple[Any, ...]]:
    things, audit = schema.things, schema.audit
    return select(audit, things).join(things, things.c.id == audit.c.thing_id)


def _change(row: Row) -> Change:
    audit, thing = schema.audit.c, thing_of({column.name: row[column] for column in schema.things.c})
    undone = row[audit.undone_us]
    with legible(f"the audit of object {thing.dataset}/{thing.id}"):
        return Change(
            at=moment_at(row[audit.at_us]),
            who=row[audit.who],
            what=row[audit.what],
            thing=thing,
            detail=_checked(json.loads(row[audit.detail])),
            undone_at=None if undone is None else moment_at(undone),
            undone_by=row[audit.undone_by],
        )


def _checked(detail: Any) -> Any:
    """What was there before and after, if it is of the form in which it is noted; an error of any kind where not."""
    for part in detail if isinstance(detail, list) else ():
        is_known = ".".join(part["field"]).startswith("known.")
        for side in (part[name] for name in ("before", "after") if is_known and name in part):
            entry_from(side)
    "/".join(detail.get("into", ()) if isinstance(detail, dict) else ())
    return detail
