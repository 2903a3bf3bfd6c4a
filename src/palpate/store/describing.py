"""Changing how an object is described and what is known of it: in one transaction, noted, and reversible."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, delete, insert, update

from palpate.store import schema
from palpate.store.audit import ADDED, CHANGED, note, row_of
from palpate.store.checks import check_entry, check_thing
from palpate.store.content import entry_plain, file_digest, to_json
from palpate.store.database import changing
from palpate.store.decoding import entry_from
from palpate.store.entries import Distribution, FailedEntry
from palpate.store.errors import StoreError
from palpate.store.records import ThingRef
from palpate.store.registry import Lookup, Registry, thing_row
from palpate.store.rows import most_probable
from palpate.store.store import Store
from palpate.store.texts import check_name, check_visible
from palpate.store.things import Image, Known, Thing, is_thing, things_where

__all__ = ["add_thing", "change_thing", "keep_image", "rewrite"]

NAMES = ("maker", "common_name", "aliases")
"""Fields that an object is known by."""
Fields = Mapping[tuple[str, ...], Any]
"""A description in its smallest parts: where each stands, and what is there."""


def add_thing(store: Store, thing: ThingRef, *, who: str | None = None) -> bool:
    """Put an object into a store before it is measured.

    Returns
    -------
    bool
        Whether it was new; one that is there stays as it is.

    Raises
    ------
    StoreError
        If the description cannot be kept.
    """
    check_thing(thing, is_new=True)
    with changing(store.engine) as connection:
        if next(things_where(connection, is_thing(thing)), None) is not None:
            return False
        row = Lookup(connection, Registry()).thing(thing)
        note(connection, row, ADDED, list(_differences({}, fields_of(Thing(thing)))), who)
        return True


def change_thing(
    store: Store, thing: ThingRef, edit: Callable[[Thing], Thing], *, who: str | None = None, is_new: bool = True
) -> Thing:
    """Change the description of an object, what is known of it, or its images.

    No recording is changed. `palpate.store.undoing.undo` takes the change back.

    Parameters
    ----------
    store
        Where it is.
    thing
        The object, by dataset and id.
    edit
        Gives the object as it shall be; see `Thing.described`, `Thing.knowing`, `Thing.without`, `Thing.showing`.
    who
        Who decided it, for the audit.
    is_new
        Whether no store has had what is said, see `palpate.store.checks.check`.

    Returns
    -------
    Thing
        As it is now.

    Raises
    ------
    StoreError
        If it is not in the store, or may not be kept so: then nothing is changed.

    Examples
    --------
    ::

        change_thing(store, mug, lambda thing: thing.knowing(Value("mass", 118.0, 1.0, "g"), "our scale"), who="ann")
    """
    with changing(store.engine) as connection:
        row = row_of(connection, "thing", thing)
        (before,) = things_where(connection, is_thing(thing))
        after = edit(before)
        rewrite(connection, row["id"], before, after, who=who, is_new=is_new)
        return after


def rewrite(
    connection: Connection,
    row: int,
    before: Thing,
    after: Thing,
    *,
    who: str | None,
    is_new: bool = True,
    again: Fields | None = None,
    gone: Sequence[tuple[str, ...]] = (),
) -> None:
    """Change and note what `change_thing` does, in a transaction.

    `again` holds already, and is said nevertheless; of `gone` something else holds, or nothing, and it is taken away
    from those who hear it.
    """
    _check(before, after, is_new=is_new)
    detail = list(_differences(fields_of(before), fields_of(after)))
    detail += ({"field": list(field), "before": value, "after": value} for field, value in (again or {}).items())
    detail += ({"field": list(field)} for field in gone)
    if detail:
        admit_known(connection, before, after)
        write(connection, row, after)
        note(connection, row, CHANGED, detail, who)


def keep_image(store: Store, name: str, media_type: str, data: bytes | Path) -> Image:
    """Put the bytes of a picture into the blobs, for `Thing.showing`."""
    check_name("image.name", name)
    check_name("image.media_type", media_type)
    digest = file_digest(data) if isinstance(data, Path) else sha256(data).hexdigest()
    store.blobs.put(digest, data)
    return Image(name, media_type, digest)


def fields_of(thing: Thing) -> Fields:
    """An object in its smallest parts."""
    fields: dict[tuple[str, ...], Any] = {}
    for name in ("maker", "common_name"):
        if getattr(thing.ref, name) is not None:
            fields[(name,)] = getattr(thing.ref, name)
    fields |= {("attributes", name): value for name, value in thing.ref.attributes.items()}
    fields |= {("aliases", name): name for name in thing.ref.aliases}
    fields |= {("known", one.entry.property or "", one.source): entry_plain(one.entry) for one in thing.known}
    return fields | {("images", one.name): [one.media_type, one.sha256] for one in thing.images}


def with_fields(thing: Thing, fields: Fields) -> Thing:
    """The object that `fields_of` would give these of."""
    parts: dict[str, dict[tuple[str, ...], Any]] = {"attributes": {}, "aliases": {}, "known": {}, "images": {}}
    for (kind, *rest), value in fields.items():
        if rest:
            parts[kind][tuple(rest)] = value
    described = thing.described(
        maker=fields.get(("maker",)),
        common_name=fields.get(("common_name",)),
        attributes={name: value for (name,), value in parts["attributes"].items()},
        aliases=tuple(parts["aliases"].values()),
    )
    known = tuple(Known(entry_from(plain), source) for (_, source), plain in parts["known"].items())
    images = tuple(Image(name, *value) for (name,), value in parts["images"].items())
    return Thing(described.ref, known, images, thing.merged_into, thing.merged, thing.recordings)


def write(connection: Connection, row: int, thing: Thing) -> None:
    """Make the rows of an object those of this description."""
    things, known, images = schema.things, schema.thing_properties, schema.thing_images
    connection.execute(update(things).where(things.c.id == row).values(**thing_row(thing.ref)))
    connection.execute(delete(known).where(known.c.thing_id == row))
    connection.execute(delete(images).where(images.c.thing_id == row))
    if thing.known:
        connection.execute(insert(known), [{"thing_id": row, **_known_row(one)} for one in thing.known])
    if thing.images:
        rows = [{"name": one.name, "media_type": one.media_type} for one in thing.images]
        digests = [bytes.fromhex(one.sha256) for one in thing.images]
        connection.execute(
            insert(images), [{"thing_id": row, **one, "blob": blob} for one, blob in zip(rows, digests, strict=True)]
        )


def _known_row(known: Known) -> dict[str, Any]:
    label = most_probable(known.entry.probabilities) if isinstance(known.entry, Distribution) else None
    document = to_json(entry_plain(known.entry))
    return {"property": known.entry.property, "source": known.source, "label": label, "document": document}


def _check(before: Thing, after: Thing, *, is_new: bool) -> None:
    if (before.ref.dataset, before.ref.id) != (after.ref.dataset, after.ref.id):
        raise StoreError(f"thing: {before.path} became {after.path}, expected dataset and name to stay: merge objects")
    check_thing(after.ref)
    if is_new:
        # what was said before may be older than this, and stays
        same = {field: text for field, text in fields_of(before).items() if field[0] in NAMES}
        for (kind, *_), text in fields_of(after).items():
            if kind in NAMES and text not in same.values():
                check_visible(f"thing.{kind}", text)
    # what was known before may be older than a dimension that everybody knows by now
    for one in (one for one in after.known if one not in before.known):
        where = f"known {one.entry.property}"
        if isinstance(one.entry, FailedEntry):
            raise StoreError(f"{where}: a failed measurement tells nothing, expected a value or a distribution")
        check_entry(where, one.entry, {}, is_new=is_new)
        check_name(f"{where}.source", one.source)


def admit_known(connection: Connection, before: Thing, after: Thing) -> None:
    """Refuse units of another dimension than those of the store's properties, of what was not known before."""
    lookup = Lookup(connection, Registry())
    for one in (one for one in after.known if one not in before.known):
        unit = getattr(one.entry, "unit", None)
        if unit is not None and one.entry.property is not None:
            lookup.admit_unit(f"known {one.entry.property}.unit", one.entry.property, unit)


def _differences(before: Fields, after: Fields) -> Iterator[dict[str, Any]]:
    """Each part that differs; what is not there is not in the item either."""
    for field in dict.fromkeys((*before, *after)):
        sides = {name: side[field] for name, side in (("before", before), ("after", after)) if field in side}
        if len(sides) < 2 or to_json(sides["before"]) != to_json(sides["after"]):
            yield {"field": list(field), **sides}
