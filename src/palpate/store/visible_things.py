"""Objects that somebody may see: in pages, and one of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from sqlalchemy import ColumnElement, Connection, Select, exists, func, or_, select, tuple_

from palpate.store import schema
from palpate.store.audit import MERGED
from palpate.store.chunks import chunks
from palpate.store.completing import ADDED, CHANGED
from palpate.store.content import to_json
from palpate.store.cursors import cursor_text, place_of
from palpate.store.describing import Fields, fields_of
from palpate.store.errors import StoreError
from palpate.store.legible import reading
from palpate.store.records import ThingRef
from palpate.store.sayings import may_know_word
from palpate.store.search_words import search_words
from palpate.store.store import Store
from palpate.store.things import Thing, is_thing, things_by_row
from palpate.store.viewing import Viewer, known_things
from palpate.store.visible_words import of_mixed, seen_refs, unsaid

__all__ = [
    "ThingFilter",
    "ThingPage",
    "as_known",
    "is_all_theirs",
    "list_visible_things",
    "listed_things",
    "rows_of",
    "things_by_name",
    "visible_thing",
]

AT_ONCE = 200


@dataclass(frozen=True)
class ThingFilter:
    """Conditions that all hold; what is None is not asked.

    Attributes
    ----------
    text
        Words, each a part of dataset, name, common name, maker or an alias, in any order and any case; of what is said
        of an object that which is seen.
    dataset
        As recorded.
    in_none_of
        Data sets that it is not of.
    known
        What the object is known to be, as pairs of property and label.
    action, property, gripper
        Of a recording of it that is seen.
    """

    text: str | None = None
    dataset: str | None = None
    in_none_of: Sequence[str] = ()
    known: Sequence[tuple[str, str]] = ()
    action: str | None = None
    property: str | None = None
    gripper: str | None = None

    def conditions(self, viewer: Viewer) -> Iterator[ColumnElement[bool]]:
        """On `schema.things`."""
        columns = schema.things.c
        for word in search_words(self.text or ""):
            yield may_know_word(viewer, word)
        if self.dataset is not None:
            yield columns.dataset == self.dataset
        if self.in_none_of:
            yield columns.dataset.not_in(self.in_none_of)
        for name, label in self.known:
            yield columns.id.in_(known_things(viewer, name, label))
        measured = list(self._measured(viewer))
        if measured:
            head = func.coalesce(schema.things.c.merged_into, schema.things.c.id)
            yield columns.id.in_(
                select(head)
                .join(schema.recordings, schema.recordings.c.thing_id == schema.things.c.id)
                .where(*measured)
            )

    def is_told(self, thing: ThingRef) -> bool:
        """Whether what is shown of an object has each word of the text."""
        said = (thing.dataset, thing.id, thing.common_name, thing.maker, *thing.aliases)
        texts = [text.casefold() for text in said if text is not None]
        return all(any(word.casefold() in text for text in texts) for word in search_words(self.text or ""))

    def _measured(self, viewer: Viewer) -> Iterator[ColumnElement[bool]]:
        recordings, entries = schema.recordings, schema.entries.c
        for name in ("action", "gripper"):
            if getattr(self, name) is not None:
                yield recordings.c[name] == getattr(self, name)
        if self.property is not None:
            yield exists().where(entries.recording_id == recordings.c.id, entries.property == self.property)
        if self.action is not None or self.gripper is not None or self.property is not None:
            yield viewer.of(recordings)


@dataclass(frozen=True)
class ThingPage:
    """Some objects, and the cursor that the next page begins after; None where there is none."""

    rows: tuple[Thing, ...]
    cursor: str | None


def list_visible_things(
    store: Store, viewer: Viewer, wanted: ThingFilter | None = None, *, limit: int = 50, cursor: str | None = None
) -> ThingPage:
    """Objects by dataset and name, those merged into another one left out; what is counted is what is seen.

    The database decides which name comes first, by its collation.

    Raises
    ------
    StoreError
        If the cursor is not of a list of objects.
    """
    asked = listed_things(viewer, wanted or ThingFilter())
    if cursor is not None:
        asked = asked.where(_is_after(*_place(cursor)))
    found = list[Thing]()
    with reading(store.engine) as connection:
        while len(found) < limit:
            page = _page(connection, viewer, asked, limit)
            found += (one for one in page if viewer.everything or wanted is None or wanted.is_told(one.ref))
            if len(page) < limit:
                break
            asked = asked.where(_is_after(page[-1].ref.dataset, page[-1].ref.id))
    found = found[:limit]
    end = _cursor(found[-1].ref) if found and len(found) == limit else None
    return ThingPage(tuple(found), end)


def _page(connection: Connection, viewer: Viewer, asked: Select[int], limit: int) -> list[Thing]:
    columns = schema.things.c
    # in the order of the database, which need not be that of Python: what comes after a cursor is in it too
    rows = connection.scalars(asked.order_by(columns.dataset, columns.name).limit(limit)).all()
    return _as_seen(connection, viewer, rows)


def _is_after(dataset: str, name: str) -> ColumnElement[bool]:
    return tuple_(schema.things.c.dataset, schema.things.c.name) > tuple_(dataset, name)


def listed_things(viewer: Viewer, wanted: ThingFilter) -> Select[int]:
    """Rows of the objects that a list has, those merged into another one left out."""
    columns = schema.things.c
    shown = (columns.merged_into.is_(None), columns.id.in_(viewer.heads()))
    return select(columns.id).where(*shown, *wanted.conditions(viewer))


def visible_thing(store: Store, viewer: Viewer, dataset: str, name: str) -> Thing | None:
    """The object of a dataset and a name, or None where there is none to see."""
    things = schema.things.c
    seen = or_(viewer.things(), things.id.in_(viewer.heads()))
    with reading(store.engine) as connection:
        rows = connection.scalars(select(things.id).where(is_thing(ThingRef(dataset, name)), seen)).all()
        return next(iter(_as_seen(connection, viewer, rows)), None)


def is_all_theirs(store: Store, name: str, thing: ThingRef) -> bool:
    """Whether each recording of an object, and of those merged into it, is somebody's, who alone has described it.

    No where there is none.
    """
    recordings = schema.recordings.c
    asked = select(func.count(), func.count().filter(is_theirs(name))).where(recordings.thing_id.in_(rows_of(thing)))
    line = schema.audit.c
    others = (line.what.in_((ADDED, CHANGED, MERGED)), line.undone_us.is_(None), func.coalesce(line.who, "") != name)
    described = select(line.id).where(line.thing_id.in_(rows_of(thing)), *others).limit(1)
    with reading(store.engine) as connection:
        count, own = connection.execute(asked).one()
        return bool(count) and bool(count == own) and connection.scalar(described) is None


def is_theirs(name: str) -> ColumnElement[bool]:
    """The condition on `schema.recordings` that one is somebody's: its owner's, else that of who has sent it."""
    columns = schema.recordings.c
    return func.coalesce(columns.owner, columns.uploaded_by) == name


def rows_of(thing: ThingRef) -> Select[int]:
    """Rows of an object and of those merged into it."""
    things = schema.things
    own = select(things.c.id).where(is_thing(thing))
    return select(things.c.id).where(or_(things.c.id.in_(own), things.c.merged_into.in_(own)))


def _as_seen(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> list[Thing]:
    """Objects by their rows, with what is merged into them and with their numbers of recordings as a viewer sees."""
    if not rows:
        return []
    things, recordings = schema.things.c, schema.recordings
    by_row = things_by_row(connection, things.id.in_(rows), are_counted=viewer.everything)
    found = {row: by_row[row] for row in rows}
    if viewer.everything:
        return list(found.values())
    heads, seen = {row: row for row in rows}, dict[int, set[tuple[str, str]]]()
    whole = [row for row, one in found.items() if one.merged]
    if whole:
        parts = select(things.id, things.merged_into, things.dataset, things.name, viewer.things())
        for key, head, dataset, name, is_seen in connection.execute(parts.where(things.merged_into.in_(whole))):
            heads[key] = head
            if is_seen:
                seen.setdefault(head, set()).add((dataset, name))
    counted = select(recordings.c.thing_id, func.count()).where(recordings.c.thing_id.in_(heads), viewer.of(recordings))
    counts = Counter[int]()
    for key, count in connection.execute(counted.group_by(recordings.c.thing_id)):
        counts[heads[key]] += count
    return [
        replace(
            one,
            merged=tuple(part for part in one.merged if (part.dataset, part.id) in seen.get(key, ())),
            recordings=counts[key],
        )
        for key, one in zip(rows, as_known(connection, viewer, found), strict=True)
    ]


def as_known(connection: Connection, viewer: Viewer, whole: Mapping[int, Thing]) -> list[Thing]:
    """Objects, which are given by their rows, with what a viewer may know of each."""
    if viewer.everything:
        return list(whole.values())
    seen = seen_refs(connection, viewer, {key: one.ref for key, one in whole.items()})
    every = {key: {(field, to_json(value)) for field, value in _told(one).items()} for key, one in whole.items()}
    doubtful = {key: parts for key, parts in unsaid(connection, viewer, every).items() if parts}
    hidden = of_mixed(connection, viewer, list(doubtful))
    left = {key: {field for field, _ in doubtful[key]} if key in hidden else set() for key in whole}
    return [_without(replace(one, ref=seen[key]), left[key]) for key, one in whole.items()]


def _told(thing: Thing) -> Fields:
    """What only persons say of an object: what is known of it, and its pictures."""
    return {field: value for field, value in fields_of(thing).items() if field[0] in ("known", "images")}


def _without(thing: Thing, hidden: Collection[tuple[str, ...]]) -> Thing:
    known = (one for one in thing.known if ("known", one.entry.property or "", one.source) not in hidden)
    images = (one for one in thing.images if ("images", one.name) not in hidden)
    return replace(thing, known=tuple(known), images=tuple(images))


def _cursor(thing: ThingRef) -> str:
    return cursor_text([thing.dataset, thing.id])


def _place(cursor: str) -> Sequence[str]:
    match place_of(cursor):
        case [str() as dataset, str() as name]:
            return dataset, name
    raise StoreError(f"cursor: {cursor!r} is not of a list of objects, expected the cursor of its last page")


def things_by_name(store: Store, viewer: Viewer, names: Collection[tuple[str, str]]) -> Mapping[tuple[str, str], Thing]:
    """Those of these objects, by dataset and name, that are seen; what is merged into them and counts are left out."""
    columns = schema.things.c
    seen = or_(viewer.things(), columns.id.in_(viewer.heads()))
    ordered, found = sorted(names), dict[tuple[str, str], Thing]()
    with reading(store.engine) as connection:
        for part in chunks(ordered, AT_ONCE):
            asked = select(columns.id).where(tuple_(columns.dataset, columns.name).in_(part), seen)
            rows = connection.scalars(asked).all()
            things = things_by_row(connection, columns.id.in_(rows), are_counted=False)
            for thing in as_known(connection, viewer, things):
                found[thing.ref.dataset, thing.ref.id] = replace(thing, merged=(), recordings=0)
    return found
