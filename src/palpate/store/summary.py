"""The table of objects x properties: mean, spread and count of what was measured."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import sqrt
from statistics import stdev
from typing import TYPE_CHECKING, Any, NamedTuple

from sqlalchemy import Row, Select, and_, func, select

from palpate.store import schema
from palpate.store.known_units import factor_of
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.units import deciding_units

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Cell", "cells_to_arrow", "objects_by_properties"]


@dataclass(frozen=True)
class Cell:
    """What was measured of one property of one object.

    Attributes
    ----------
    dataset, thing
        The object; what was measured of objects merged into it counts.
    property, unit
        The property, and the unit that it was first given in, which the numbers below are in.
    mean, sd
        Of all values; the SD (n - 1) is None for a single one.
    count
        Of values.
    devices
        Number of setups that measured.
    between_devices_sd
        SD (n - 1) of the means of the setups; None for a single one.
    """

    dataset: str
    thing: str
    property: str
    unit: str
    mean: float
    sd: float | None
    count: int
    devices: int
    between_devices_sd: float | None


def objects_by_properties(store: Store) -> list[Cell]:
    """Summarise all values that have a unit, by object and property; none of which the unit is not known here."""
    with reading(store.engine) as connection:
        groups = connection.execute(_groups()).all()
        units = deciding_units(connection)
        columns = schema.things.c
        # nothing else is read, so that a description that is damaged hides no measurement
        asked = select(columns.id, columns.dataset, columns.name, columns.merged_into)
        things = {row.id: row for row in connection.execute(asked)}
        measured: dict[tuple[int, str], list[Group]] = defaultdict(list)
        for thing, name, count, mean, squares in groups:
            measured[things[thing].merged_into or thing, name].append(Group(count, mean, squares))
        scales = {name: factor_of(unit) for name, unit in units.items()}
        cells = [
            _cell(things[thing], name, units[name], scale, parts)
            for (thing, name), parts in measured.items()
            if (scale := scales[name]) is not None
        ]
    return sorted(cells, key=lambda cell: (cell.dataset, cell.thing, cell.property))


def cells_to_arrow(cells: Sequence[Cell]) -> pyarrow.Table:
    """The cells as an Arrow table, a row for each, which pandas and Polars read as it is."""
    import pyarrow as pa

    kinds = {"str": pa.string(), "float": pa.float64(), "float | None": pa.float64(), "int": pa.int64()}
    columns = pa.schema([(field.name, kinds[str(field.type)]) for field in fields(Cell)])
    return pa.Table.from_pylist([vars(cell) for cell in cells], schema=columns)


class Group(NamedTuple):
    """What one setup measured: number of values, their mean, and the sum of squared differences from it."""

    values: int
    mean: float
    squares: float


def _groups() -> Select[int, str, int, float, float]:
    """Object, property and group, for each setup; the mean first, so that no digits are lost in the squares."""
    entries = schema.entries.c
    keys = (entries.property, entries.thing_id, entries.setup_id)
    valued = and_(entries.property.is_not(None), entries.value_si.is_not(None))
    mean, count = func.avg(entries.value_si), func.count()
    means = select(*keys, count.label("count"), mean.label("mean")).where(valued).group_by(*keys).cte("means")
    off = entries.value_si - means.c.mean
    same = and_(*(key == means.c[key.name] for key in keys))
    return (
        select(means.c.thing_id, means.c.property, means.c["count"], means.c.mean, func.sum(off * off))
        .join(schema.entries, and_(same, entries.value_si.is_not(None)))
        .group_by(means.c.property, means.c.thing_id, means.c.setup_id, means.c["count"], means.c.mean)
    )


def _cell(thing: Row[*tuple[Any, ...]], name: str, unit: str, scale: float, parts: Sequence[Group]) -> Cell:
    count = sum(part.values for part in parts)
    mean = sum(part.values * part.mean for part in parts) / count
    squares = sum(part.squares + part.values * (part.mean - mean) ** 2 for part in parts)
    between = stdev(part.mean for part in parts) / scale if len(parts) > 1 else None
    sd = sqrt(squares / (count - 1)) / scale if count > 1 else None
    return Cell(thing.dataset, thing.name, name, unit, mean / scale, sd, count, len(parts), between)
