"""Which properties can be compared with what is known: one question for all, however many properties there are."""

from __future__ import annotations

from sqlalchemy import exists, select, true, union

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["properties_with_truth"]


def properties_with_truth(store: Store, viewer: Viewer) -> tuple[str, ...]:
    """Properties, by name, of which somebody sees a number of a recording that is known to be true, or one is said.

    Whether that is of an object that is seen and measured is for who compares them.
    """
    entries, recordings = schema.entries.c, schema.recordings
    said, units = schema.thing_properties.c, schema.properties.c
    # few recordings are known to be true: to find these first takes a tenth of looking up the one of each result
    known = select(recordings.c.id).where(recordings.c.ground_truth == true(), viewer.of(recordings))
    measured = select(entries.property).where(
        entries.recording_id.in_(known), entries.property.is_not(None), entries.value_si.is_not(None)
    )
    # what is said with a label is no number
    told = select(said.property).where(said.label.is_(None))
    names = union(measured, told).subquery()
    has_unit = exists().where(units.name == names.c.property, units.unit.is_not(None))
    with reading(store.engine) as connection:
        return tuple(sorted(connection.scalars(select(names.c.property).where(has_unit))))
