"""Results that tell a number's bound or interval only, counted: a mean of values passes them over."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Mapping

from sqlalchemy import false, func, select

from palpate.network.units import unit_of
from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.fetching import setup_of
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.units import deciding_units
from palpate.store.viewing import Viewer
from palpate.store.visible_results import measured_by

__all__ = ["Censored", "censored_of"]


Censored = Counter[tuple[str, tuple[str, str]]]
"""How many results there are, by what measured them and the object, as data set and name."""


def censored_of(store: Store, viewer: Viewer, properties: Collection[str]) -> Mapping[str, Censored]:
    """How many there are of each of these properties.

    Without those that are known to be true, and without numbers whose unit is not stated or is of another dimension
    than the property's, which do not count (see `palpate.store.units`). What was measured of objects merged into
    another one counts as that one's.
    """
    entries, recordings, setups, things = schema.entries.c, schema.recordings, schema.setups, schema.things
    own, head = things.alias("own"), things.alias("head")
    keys = (entries.property, entries.unit, setups.c.digest, setups.c.document, head.c.dataset, head.c.name)
    asked = (
        select(*keys, func.count().label("number"))
        .join_from(schema.entries, recordings, recordings.c.id == entries.recording_id)
        .join(setups, setups.c.id == entries.setup_id)
        .join(own, own.c.id == entries.thing_id)
        .join(head, head.c.id == func.coalesce(own.c.merged_into, own.c.id))
        # without a unit there is no telling what a number is
        .where(entries.kind.in_(("bound", "interval")), entries.unit.is_not(None))
        .where(recordings.c.ground_truth.is_(false()), viewer.of(recordings))
        .group_by(*keys)
    )
    names, found = list(properties), defaultdict[str, Censored](Counter)
    with reading(store.engine) as connection:
        units = deciding_units(connection)
        for part in chunks(names):
            for row in connection.execute(asked.where(entries.property.in_(part))):
                told = units.get(row.property)
                if told is not None and unit_of(row.unit).dimension == unit_of(told).dimension:
                    device = measured_by(setup_of(row.digest, row.document))
                    found[row.property][device, (row.dataset, row.name)] += row.number
    return found
