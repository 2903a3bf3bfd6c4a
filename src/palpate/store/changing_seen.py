"""Changing what somebody sees of an object: what they do not see stays, and they are told what they see of changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from hashlib import sha256
from typing import Any

from sqlalchemy import or_, select

from palpate.store import schema
from palpate.store.audit import MERGED, Change, history
from palpate.store.content import to_json
from palpate.store.describing import change_thing, fields_of, with_fields
from palpate.store.errors import StoreError
from palpate.store.legible import reading
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing, is_thing
from palpate.store.viewing import Viewer
from palpate.store.visible_things import visible_thing
from palpate.store.visible_words import Part, hidden_parts

__all__ = ["ChangedMeanwhileError", "change_seen", "seen_history", "version_of"]


class ChangedMeanwhileError(StoreError):
    """What is to be changed is no longer what it was when somebody looked at it."""


def version_of(thing: Thing) -> str:
    """What tells a description from any other."""
    said = to_json([[list(field), value] for field, value in fields_of(thing).items()])
    return sha256(said.encode()).hexdigest()[:16]


def change_seen(
    store: Store,
    viewer: Viewer,
    thing: ThingRef,
    edit: Callable[[Thing], Thing],
    *,
    who: str | None = None,
    version: str | None = None,
) -> Thing:
    """As `palpate.store.describing.change_thing`, with an object as a viewer sees it.

    Parameters
    ----------
    version
        That of the object as somebody has looked at it; whichever it is now where it is None.

    Raises
    ------
    ChangedMeanwhileError
        If it has another version now.
    StoreError
        As of `palpate.store.describing.change_thing`.
    """

    def changed(whole: Thing) -> Thing:
        seen = visible_thing(store, viewer, thing.dataset, thing.id)
        if seen is None:
            raise StoreError(f"thing: {thing.dataset}/{thing.id} is not in the store, expected an object that is")
        if version is not None and version != version_of(seen):
            raise ChangedMeanwhileError(
                f"object {seen.path}: was changed since this page was loaded, expected what it says now: look at it "
                "and save again"
            )
        before, after = fields_of(seen), fields_of(edit(seen))
        hidden = {field: value for field, value in fields_of(whole).items() if field not in before}
        # what is hidden stands behind what is seen, and gives way to it
        return with_fields(whole, {**after, **{field: value for field, value in hidden.items() if field not in after}})

    return change_thing(store, thing, changed, who=who)


def seen_history(store: Store, viewer: Viewer, thing: ThingRef) -> tuple[Change, ...]:
    """What a viewer may know of the changes of an object, the first first."""
    told = history(store, thing, or_(viewer.hears(holding=False), schema.audit.c.what == MERGED))
    with reading(store.engine) as connection:
        row = connection.scalar(select(schema.things.c.id).where(is_thing(thing)))
        if row is None or viewer.everything:
            return told
        hidden = hidden_parts(connection, viewer, {row: {part for one in told for part in _before(one)}})[row]
    return tuple(replace(one, detail=_without(one.detail, hidden)) for one in told)


def _before(change: Change) -> Iterator[Part]:
    for part in change.detail if isinstance(change.detail, list) else ():
        if "before" in part:
            yield tuple(part["field"]), to_json(part["before"])


def _without(detail: Any, hidden: set[Part]) -> Any:
    if not isinstance(detail, list):
        return detail
    return [
        {
            name: side
            for name, side in part.items()
            if name != "before" or (tuple(part["field"]), to_json(side)) not in hidden
        }
        for part in detail
    ]
