"""Objects in a store: how each is described, and what is known of it beside what was measured."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from sqlalchemy import ColumnElement, Connection, Select, func, literal, or_, select

from palpate.errors import choices, near
from palpate.store import schema
from palpate.store.checks import check_entry
from palpate.store.decoding import entry_from
from palpate.store.each_thing import each_thing
from palpate.store.entries import Bound, Entry, Interval, Value
from palpate.store.errors import DamagedError, IncompleteError, StoreError
from palpate.store.filters import called
from palpate.store.known_units import is_known_unit
from palpate.store.legible import legible, reading
from palpate.store.listing import Damaged
from palpate.store.records import ThingRef
from palpate.store.registry import thing_of
from palpate.store.store import Store
from palpate.store.texts import check_name

__all__ = ["Image", "Known", "Thing", "find_thing", "list_things"]

Row = Mapping[Any, Any]
T = TypeVar("T")


@dataclass(frozen=True)
class Known:
    """What is known of a property of an object, and from where: a data sheet, a scale, a person."""

    entry: Entry
    source: str


@dataclass(frozen=True)
class Image:
    """A picture of an object; its bytes are in the blobs under their SHA-256."""

    name: str
    media_type: str
    sha256: str


@dataclass(frozen=True)
class Thing:
    """An object as a store has it.

    Attributes
    ----------
    ref
        Dataset and name there, which never change, and how it is described.
    known
        At most one item for each property and source.
    images
        Pictures of it.
    merged_into
        The object that it counts as; None where it is one of its own.
    merged
        The objects that count as this one.
    recordings
        How many there are, of it and of what is merged into it.
    """

    ref: ThingRef
    known: tuple[Known, ...] = ()
    images: tuple[Image, ...] = ()
    merged_into: ThingRef | None = None
    merged: tuple[ThingRef, ...] = ()
    recordings: int = 0

    @property
    def path(self) -> str:
        """Dataset and name, as ``ycb/025_mug``: what tells it from all others."""
        return f"{self.ref.dataset}/{self.ref.id}"

    def described(self, **fields: Any) -> Thing:
        """The same with another maker, common name, attributes or aliases."""
        return replace(self, ref=replace(self.ref, **fields))

    def knowing(self, entry: Entry, source: str) -> Thing:
        """The same with something known, in place of what that source said of the property before."""
        others = (one for one in self.known if (one.entry.property, one.source) != (entry.property, source))
        return replace(self, known=(*others, Known(entry, source)))

    def without(self, property: str, source: str | None = None) -> Thing:
        """The same without what a source, or any source, says of a property."""
        kept = (one for one in self.known if one.entry.property != property or source not in (None, one.source))
        return replace(self, known=tuple(kept))

    def showing(self, image: Image) -> Thing:
        """The same with a picture, in place of one of that name."""
        return replace(self, images=(*(one for one in self.images if one.name != image.name), image))


def list_things(store: Store, damaged: Damaged | None = None) -> tuple[Thing, ...]:
    """All objects, by dataset and name.

    Parameters
    ----------
    store
        Where to look.
    damaged
        Is told of each object that cannot be read, and the list has none of it; unless given, the first one is raised.

    Raises
    ------
    DamagedError
        If an object cannot be read.
    """
    with reading(store.engine) as connection:
        return tuple(sorted(_all_things(connection, damaged), key=lambda thing: thing.path))


def _all_things(connection: Connection, damaged: Damaged | None) -> list[Thing]:
    column = schema.things.c.id
    try:
        return list(things_where(connection, literal(True)))
    except IncompleteError:
        raise
    except DamagedError:
        if damaged is None:
            raise
    rows = connection.scalars(select(column).order_by(column)).all()
    found = each_thing(connection, rows, lambda row: list(things_where(connection, column == row)), damaged)
    return [thing for _, things in found for thing in things]


def find_thing(store: Store, name: str) -> Thing:
    """The object of a name: its name in its dataset, its common name, an alias, or ``DATASET/NAME``.

    Where several of one name were merged, it is the one that they count as.

    Raises
    ------
    StoreError
        If there is none, or there are several.
    """
    with reading(store.engine) as connection:
        found = list(things_where(connection, called(name)))
        counted = {(head.dataset, head.id): head for head in (thing.merged_into or thing.ref for thing in found)}
        if len(found) > 1 and len(counted) == 1:
            (head,) = counted.values()
            found = list(things_where(connection, is_thing(head)))
        if len(found) == 1:
            return found[0]
        paths = [thing.path for thing in found] or _names(connection)
    if found:
        raise StoreError(f"object {name!r}: {len(found)} are called so; {choices(sorted(paths))}")
    raise StoreError(
        f"object {name!r}: is not in the store{near(name, paths)}, expected one of `palpate store objects`"
    )


def is_thing(thing: ThingRef) -> ColumnElement[bool]:
    """The condition on `schema.things` that one is this."""
    columns = schema.things.c
    return (columns.dataset == thing.dataset) & (columns.name == thing.id)


def things_where(connection: Connection, condition: ColumnElement[bool]) -> Iterator[Thing]:
    """The objects for which a condition on `schema.things` holds, in the order in which they came."""
    yield from things_by_row(connection, condition).values()


def things_by_row(
    connection: Connection, condition: ColumnElement[bool], *, are_counted: bool = True
) -> dict[int, Thing]:
    """As `things_where`, by their rows; recordings need not be counted where not all of them are seen."""
    things = schema.things
    asked = select(things.c.id).where(condition)
    rows = connection.execute(select(things).where(condition).order_by(things.c.id)).mappings().all()
    if not rows:
        return {}
    known, images = _parts(connection, schema.thing_properties, asked), _parts(connection, schema.thing_images, asked)
    merged = _grouped(connection.execute(select(things).where(things.c.merged_into.in_(asked))), "merged_into")
    heads = _heads(connection, asked) if any(row["merged_into"] is not None for row in rows) else {}
    counts = _counts(connection, asked) if are_counted else {}
    return {
        (key := row["id"]): Thing(
            thing_of(row),
            tuple(known_of(one, row) for one in known[key]),
            tuple(Image(one["name"], one["media_type"], one["blob"].hex()) for one in images[key]),
            heads.get(row["merged_into"]),
            tuple(thing_of(one) for one in merged[key]),
            counts.get(key, 0) + sum(counts.get(one["id"], 0) for one in merged[key]),
        )
        for row in rows
    }


def known_of(row: Row, thing: Row) -> Known:
    """What is known of an object, from its rows; DamagedError where it is nothing that could have been told."""
    where = f"object {thing['dataset']}/{thing['name']}: what is known of its {row['property']}"
    with legible(where):
        entry = entry_from(json.loads(row["document"]))
    try:
        # no digest covers it
        check_entry("entry", _without_unknown_unit(entry), {}, is_new=False)
    except StoreError as error:
        raise DamagedError(f"{where}: {error}") from None
    return Known(entry, row["source"])


def _without_unknown_unit(entry: Entry) -> Entry:
    """An entry to check: its unit may be one that a program kept which knows more units than this one."""
    unit = getattr(entry, "unit", None)
    if isinstance(entry, Value | Interval | Bound) and isinstance(unit, str) and not is_known_unit(unit):
        check_name("entry.unit", unit)
        return replace(entry, unit=None)
    return entry


def _names(connection: Connection) -> list[str]:
    columns = schema.things.c
    found = connection.execute(select(columns.dataset, columns.name, columns.common_name))
    return [name for row in found for name in (row[1], row[2], f"{row[0]}/{row[1]}") if name]


def _parts(connection: Connection, table: Any, asked: Select[int]) -> Mapping[int, Sequence[Row]]:
    order = table.c.id if "id" in table.c else table.c.name
    return _grouped(connection.execute(select(table).where(table.c.thing_id.in_(asked)).order_by(order)), "thing_id")


def _grouped(found: Any, key: str) -> Mapping[int, list[Row]]:
    groups: dict[int, list[Row]] = defaultdict(list)
    for row in found.mappings():
        groups[row[key]].append(row)
    return groups


def _heads(connection: Connection, asked: Select[int]) -> Mapping[int, ThingRef]:
    things = schema.things
    heads = select(things.c.merged_into).where(things.c.id.in_(asked), things.c.merged_into.is_not(None))
    found = connection.execute(select(things).where(things.c.id.in_(heads))).mappings()
    return {row["id"]: thing_of(row) for row in found}


def _counts(connection: Connection, asked: Select[int]) -> Mapping[int, int]:
    """Recordings of the objects, and of those merged into them."""
    thing_id = schema.recordings.c.thing_id
    those = select(schema.things.c.id).where(or_(schema.things.c.id.in_(asked), schema.things.c.merged_into.in_(asked)))
    found: Iterable[Any] = connection.execute(
        select(thing_id, func.count()).where(thing_id.in_(those)).group_by(thing_id)
    )
    return {row[0]: row[1] for row in found}
