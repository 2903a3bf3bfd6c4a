"""Results that tell a number's bound or interval only, counted: a mean of values passes them over."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import false, func, select

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.fetching import setup_of
from palpate.store.known_units import are_alike, is_known_unit
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.units import deciding_units
from palpate.store.viewing import Viewer
from palpate.store.visible_results import measured_by

__all__ = ["Censored", "censored_of"]


@dataclass
class Censored:
    """How many results of a property there are, by what measured them and the object, as data set and name.

    `unknown_units` are those of results that are left out, as they are not known here.
    """

    counts: Counter[tuple[str, tuple[str, str]]] = field(default_factory=Counter)
    unknown_units: set[str] = field(default_factory=set)


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
    names = list(properties)
    found = {name: Censored() for name in names}
    with reading(store.engine) as connection:
        units = deciding_units(connection)
        for part in chunks(names):
            for row in connection.execute(asked.where(entries.property.in_(part))):
                _add(row, units.get(row.property), found[row.property])
    return found


def _add(row: Any, told: str | None, to: Censored) -> None:
    unknown = {unit for unit in (row.unit, told) if unit is not None and not is_known_unit(unit)}
    to.unknown_units |= unknown
    if not unknown and told is not None and are_alike(row.unit, told):
        device = measured_by(setup_of(row.digest, row.document))
        to.counts[device, (row.dataset, row.name)] += row.number
