"""What a store has of a property: labels, or numbers."""

from __future__ import annotations

from sqlalchemy import or_, select

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.store import Store

__all__ = ["has_numbers", "labels_of"]


def labels_of(store: Store, name: str) -> frozenset[str]:
    """The most probable labels of a property that were measured, or are known of objects."""
    found: set[str] = set()
    with reading(store.engine) as connection:
        for table in (schema.entries, schema.thing_properties):
            asked = select(table.c.label).where(table.c.property == name, table.c.label.is_not(None)).distinct()
            found.update(connection.scalars(asked))
    return frozenset(found)


def has_numbers(store: Store, name: str) -> bool:
    """Whether a number of a property was measured, or is known of an object."""
    entries, known = schema.entries.c, schema.thing_properties.c
    numbers = or_(entries.value.is_not(None), entries.low.is_not(None), entries.high.is_not(None))
    measured = select(entries.recording_id).where(entries.property == name, numbers).limit(1)
    told = select(known.id).where(known.property == name, known.label.is_(None)).limit(1)
    with reading(store.engine) as connection:
        return any(connection.scalar(asked) is not None for asked in (measured, told))
