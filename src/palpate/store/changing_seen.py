"""Changing what somebody sees of an object: what they do not see stays, and they are told what they see of changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any

from sqlalchemy import ColumnElement, Connection, and_, literal, or_, select

from palpate.store import schema
from palpate.store.audit import MERGED, Change, history, row_of
from palpate.store.content import to_json
from palpate.store.database import changing
from palpate.store.describing import Fields, fields_of, rewrite, with_fields
from palpate.store.errors import StoreError
from palpate.store.json_columns import JsonText
from palpate.store.legible import reading
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing, is_thing, things_where
from palpate.store.undoing import undo
from palpate.store.viewing import Viewer
from palpate.store.visible_things import visible_thing
from palpate.store.visible_words import Part, hidden_parts, unsaid

__all__ = ["ChangedMeanwhileError", "change_seen", "seen_history", "undo_seen", "version_of"]

EVERYBODY = Viewer(everything=True)
"""What somebody has said, whoever hears it."""


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
        As of `palpate.store.describing.change_thing`, or if a field would be set of which a person has said something
        that the viewer does not see.
    """
    with changing(store.engine) as connection:
        row = row_of(connection, "thing", thing)["id"]
        (whole,) = things_where(connection, is_thing(thing))
        seen = visible_thing(store, viewer, thing.dataset, thing.id)
        if seen is None:
            raise StoreError(f"thing: {thing.dataset}/{thing.id} is not in the store, expected an object that is")
        if version is not None and version != version_of(seen):
            raise ChangedMeanwhileError(
                f"object {seen.path}: was changed since this page was loaded, expected what it says now: look at it "
                "and save again"
            )
        edited = _Edit(fields_of(whole), fields_of(seen), fields_of(edit(seen)))
        _check_free(connection, row, seen.path, edited.covered())
        changed = with_fields(whole, edited.fields())
        rewrite(connection, row, whole, changed, who=who, again=edited.again(), gone=edited.gone())
        return changed


@dataclass(frozen=True)
class _Edit:
    """What somebody changes, of a whole description of which they see something else: what they leave alone stays."""

    whole: Fields
    before: Fields
    after: Fields

    def fields(self) -> Fields:
        """The whole as it is then; what is hidden stands behind what is seen, and gives way to what they say."""
        told = {field: value for field, value in self.after.items() if self._is_changed(field) or field in self.whole}
        seen = {field: value if self._is_changed(field) else self.whole[field] for field, value in told.items()}
        rest = {field: value for field, value in self.whole.items() if field not in self.after}
        return {**seen, **{field: value for field, value in rest.items() if not _is_same(self.before, field, value)}}

    def covered(self) -> Fields:
        """What they would replace without seeing it."""
        hidden = (field for field in self.after if field in self.whole and self._is_changed(field))
        return {field: self.whole[field] for field in hidden if not _is_same(self.before, field, self.whole[field])}

    def again(self) -> Fields:
        """What holds already without their seeing it: it is said by them too."""
        return {
            field: self.after[field] for field, value in self.covered().items() if _is_same(self.after, field, value)
        }

    def gone(self) -> Sequence[tuple[str, ...]]:
        """What they take away of what is shown to them, where the whole says nothing of it, or something else."""
        removed = ((field, value) for field, value in self.before.items() if field not in self.after)
        return [field for field, value in removed if not _is_same(self.whole, field, value)]

    def _is_changed(self, field: tuple[str, ...]) -> bool:
        return not _is_same(self.before, field, self.after[field])


def _is_same(fields: Fields, field: tuple[str, ...], value: Any) -> bool:
    return field in fields and to_json(fields[field]) == to_json(value)


def _check_free(connection: Connection, row: int, path: str, hidden: Fields) -> None:
    """Refuse to set what a person has said, whether it is set to the same or not; an alias stands beside others."""
    parts = {(field, to_json(value)) for field, value in hidden.items() if field[0] != "aliases"}
    said = parts - unsaid(connection, EVERYBODY, {row: parts})[row]
    if said:
        (field, _) = min(said)
        raise StoreError(
            f"object {path}: {'.'.join(field)}: somebody has said it where you do not see it, expected a field "
            "that you see, or that nobody has filled in: ask an administrator to change it"
        )


def undo_seen(store: Store, viewer: Viewer, thing: ThingRef, *, who: str | None = None) -> Change:
    """As `palpate.store.undoing.undo`, of those changes that a viewer sees."""
    return undo(store, thing, who=who, among=or_(viewer.hears(), _is_merge_seen(viewer)))


def seen_history(store: Store, viewer: Viewer, thing: ThingRef) -> tuple[Change, ...]:
    """What a viewer may know of the changes of an object, the first first."""
    told = history(store, thing, or_(viewer.hears(holding=False), _is_merge_seen(viewer)))
    with reading(store.engine) as connection:
        row = connection.scalar(select(schema.things.c.id).where(is_thing(thing)))
        if row is None or viewer.everything:
            return told
        hidden = hidden_parts(connection, viewer, {row: {part for one in told for part in _before(one)}})[row]
    return tuple(replace(one, detail=_without(one.detail, hidden)) for one in told)


def _is_merge_seen(viewer: Viewer) -> ColumnElement[bool]:
    """The condition on `schema.audit` that an object was merged into one that a viewer sees."""
    things, line = schema.things.c, schema.audit.c
    named = literal('{"into":[') + JsonText(things.dataset) + literal(",") + JsonText(things.name) + literal("]}")
    seen = select(named).where(or_(viewer.things(), things.id.in_(viewer.heads())))
    is_merge = line.what == MERGED
    return is_merge if viewer.everything else and_(is_merge, line.detail.in_(seen))


def _before(change: Change) -> Iterator[Part]:
    for part in change.detail if isinstance(change.detail, list) else ():
        if "before" in part:
            yield tuple(part["field"]), to_json(part["before"])


def _without(detail: Any, hidden: set[Part]) -> Any:
    if not isinstance(detail, list):
        return detail
    return [
        {name: side for name, side in part.items() if name != "before" or not _is_unknown(part, hidden)}
        for part in detail
    ]


def _is_unknown(part: Mapping[str, Any], hidden: set[Part]) -> bool:
    """Whether what was there is hidden, or was when the same was said."""
    before = to_json(part["before"])
    return (tuple(part["field"]), before) in hidden or before == to_json(part.get("after"))
