"""What a store has of a property, as far as somebody sees it: labels, or numbers, and a unit of these."""

from __future__ import annotations

from typing import Any

from sqlalchemy import ColumnElement, Select, or_, select, true

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["has_numbers", "labels_of", "seen_unit"]

ALL = Viewer(everything=True)


def labels_of(store: Store, name: str, viewer: Viewer = ALL) -> frozenset[str]:
    """The most probable labels of a property that were measured, or are known of objects."""
    entries, known = schema.entries.c, schema.thing_properties.c
    measured = select(entries.label).where(entries.property == name, entries.label.is_not(None), _measured(viewer))
    told = select(known.label).where(known.property == name, known.label.is_not(None), _told(viewer))
    with reading(store.engine) as connection:
        return frozenset(label for asked in (measured, told) for label in connection.scalars(asked.distinct()) if label)


def has_numbers(store: Store, name: str, viewer: Viewer = ALL) -> bool:
    """Whether a number of a property was measured, or is known of an object."""
    entries, known = schema.entries.c, schema.thing_properties.c
    numbers = or_(entries.value.is_not(None), entries.low.is_not(None), entries.high.is_not(None))
    measured = select(entries.recording_id).where(entries.property == name, numbers, _measured(viewer))
    told = select(known.id).where(known.property == name, known.label.is_(None), _told(viewer))
    return _is_any(store, measured, told)


def seen_unit(store: Store, name: str, viewer: Viewer) -> str | None:
    """A unit that a result of a property is seen to be in."""
    entries = schema.entries.c
    asked = select(entries.unit).where(entries.property == name, entries.unit.is_not(None), _measured(viewer)).limit(1)
    with reading(store.engine) as connection:
        return connection.scalar(asked)


def _is_any(store: Store, *some: Select[Any]) -> bool:
    with reading(store.engine) as connection:
        return any(connection.scalar(asked.limit(1)) is not None for asked in some)


def _measured(viewer: Viewer) -> ColumnElement[bool]:
    recordings = schema.recordings
    if viewer.everything:
        return true()
    seen = select(recordings.c.id).where(recordings.c.id == schema.entries.c.recording_id, viewer.of(recordings))
    return seen.exists()


def _told(viewer: Viewer) -> ColumnElement[bool]:
    things = schema.things
    if viewer.everything:
        return true()
    return select(things.c.id).where(things.c.id == schema.thing_properties.c.thing_id, viewer.things()).exists()
