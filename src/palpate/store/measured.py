"""What was measured of one object: by property, and by the devices that measured."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev
from typing import Any

from sqlalchemy import or_, select

from palpate.store import schema
from palpate.store.fetching import setup_of
from palpate.store.known_units import factor_of
from palpate.store.legible import reading
from palpate.store.records import Setup, ThingRef
from palpate.store.store import Store
from palpate.store.things import is_thing
from palpate.store.units import deciding_units

__all__ = ["Measured", "measured_of"]


@dataclass(frozen=True)
class Measured:
    """Results of one property of an object by one setup.

    Attributes
    ----------
    property
        None for failures of whole measurements.
    setup
        The devices.
    results, failed
        How many there are, and how many of them failed.
    mean, sd, unit
        Of the values that have a unit, in the unit that the property was first given in; the SD (n - 1) is None for
        a single one, and all are None where that unit is not known here.
    labels
        Most probable label to how often it was.
    """

    property: str | None
    setup: Setup
    results: int
    failed: int
    mean: float | None
    sd: float | None
    unit: str | None
    labels: Mapping[str, int]


def measured_of(store: Store, thing: ThingRef) -> tuple[Measured, ...]:
    """What was measured of an object and of those merged into it, by property and setup."""
    things, entries = schema.things, schema.entries.c
    own = select(things.c.id).where(is_thing(thing))
    those = select(things.c.id).where(or_(things.c.id.in_(own), things.c.merged_into.in_(own)))
    columns = (entries.property, entries.setup_id, entries.kind, entries.value_si, entries.label)
    groups: dict[tuple[str | None, int], list[Any]] = defaultdict(list)
    with reading(store.engine) as connection:
        for row in connection.execute(select(*columns).where(entries.thing_id.in_(those))):
            groups[row.property, row.setup_id].append(row)
        units = deciding_units(connection)
        needed = schema.setups.c.id.in_({setup for _, setup in groups})
        setups = {
            row.id: setup_of(row.digest, row.document)
            for row in connection.execute(select(schema.setups).where(needed))
        }
        # failures of no property come last
        order = sorted(groups, key=lambda key: (key[0] is None, key[0] or "", key[1]))
        return tuple(
            _measured(name, setups[setup], groups[name, setup], units.get(name or "")) for name, setup in order
        )


def _measured(name: str | None, setup: Setup, rows: Sequence[Any], unit: str | None) -> Measured:
    scale = None if unit is None else factor_of(unit)
    values = [row.value_si for row in rows if row.value_si is not None and scale is not None]
    return Measured(
        property=name,
        setup=setup,
        results=len(rows),
        failed=sum(row.kind == "failed" for row in rows),
        mean=fmean(values) / (scale or 1.0) if values else None,
        sd=stdev(values) / (scale or 1.0) if len(values) > 1 else None,
        unit=unit if values else None,
        labels=Counter(row.label for row in rows if row.label is not None),
    )
