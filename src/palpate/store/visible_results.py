"""Results that somebody may see, each with what measured it: for plots and tables of one or several objects."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import lru_cache
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, Connection, Select, and_, func, select

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.fetching import setup_of
from palpate.store.known_units import factor_of, scale
from palpate.store.legible import reading
from palpate.store.records import Setup, ThingRef
from palpate.store.rows import moment_at
from palpate.store.store import Store
from palpate.store.texts import LARGEST_SI
from palpate.store.units import deciding_units
from palpate.store.viewing import Viewer
from palpate.store.visible_things import rows_of

__all__ = ["Given", "Group", "Grouped", "Result", "groups_of", "is_measurable", "measured_by", "results_of"]


@dataclass(frozen=True)
class Given:
    """The number of a result, or its ends, in the unit in which it was given; None where it was not stated."""

    value: float | None
    low: float | None
    high: float | None
    unit: str | None


@dataclass(frozen=True)
class Result:
    """One result.

    Attributes
    ----------
    value, sd, unit
        In the unit that the property was first given in; None where it is no number with a unit of that dimension, or
        with one that is not known here and was not when the number was kept.
    low, high
        Ends of an interval or a bound, likewise.
    given
        The number as it was given, where it cannot be told in that unit.
    label
        The most probable label.
    owner
        Of its recording.
    measured_by
        The gripper, or where there is none the first device that the setup names, or "nothing that is named".
    """

    recording: UUID
    recorded_at: datetime
    action: str
    ground_truth: bool
    dataset: str
    thing: str
    kind: str
    property: str | None
    value: float | None
    sd: float | None
    low: float | None
    high: float | None
    unit: str | None
    given: Given | None
    label: str | None
    owner: str | None
    measured_by: str


def results_of(store: Store, viewer: Viewer, thing: ThingRef) -> tuple[Result, ...]:
    """All results of an object and of those merged into it, the first measured first."""
    with reading(store.engine) as connection:
        return tuple(_results(connection, viewer, _heads(connection, thing)))


@dataclass(frozen=True)
class Group:
    """The values that one setup measured of one object: how many, their mean, and the sum of squares about it.

    In the unit that the property was first given in; `ground_truth` where they are known to be true.
    """

    dataset: str
    thing: str
    measured_by: str
    ground_truth: bool
    count: int
    mean: float
    squares: float


@dataclass
class Grouped:
    """The values of a property, with its unit; and the units, unknown here, of values that are left out."""

    unit: str
    groups: list[Group] = field(default_factory=list)
    unknown_units: set[str] = field(default_factory=set)


def groups_of(store: Store, viewer: Viewer, properties: Collection[str]) -> Mapping[str, Grouped]:
    """Of each of these properties its values, by object, setup, and whether they are known to be true.

    What was measured of objects merged into another one counts as that one's. A value counts by what it was found to be
    in SI units when it was kept, also where its own unit is not known here.
    """
    setups, things = schema.setups, schema.things
    names = list(properties)
    with reading(store.engine) as connection:
        units = deciding_units(connection)
        found = {name: Grouped(units.get(name) or "") for name in names}
        for part in chunks(names):
            groups = _groups(viewer, part).subquery()
            asked = (
                select(groups, setups.c.digest, setups.c.document, things.c.dataset, things.c.name)
                .join(setups, setups.c.id == groups.c.setup_id)
                .join(things, things.c.id == groups.c.head)
            )
            for row in connection.execute(asked):
                _add(row, found[row.property])
    return found


def _add(row: Any, to: Grouped) -> None:
    told = factor_of(to.unit)
    if told is None:
        to.unknown_units.add(to.unit)
    else:
        to.groups.append(_group(row, told))


def _group(row: Any, scale: float) -> Group:
    return Group(
        dataset=row.dataset,
        thing=row.name,
        measured_by=measured_by(setup_of(row.digest, row.document)),
        ground_truth=bool(row.ground_truth),
        count=row.number,
        mean=row.mean / scale,
        squares=row.squares / scale**2,
    )


def _groups(viewer: Viewer, properties: Collection[str]) -> Select[*tuple[Any, ...]]:
    """Property, head, setup, truth, count, mean and squares; the mean first, so that no digits are lost in squares."""
    entries, recordings, things = schema.entries.c, schema.recordings, schema.things
    head = func.coalesce(things.c.merged_into, things.c.id)
    values = (
        select(entries.property, head.label("head"), entries.setup_id, recordings.c.ground_truth, entries.value_si)
        .join(recordings, recordings.c.id == entries.recording_id)
        .join(things, things.c.id == entries.thing_id)
        .where(entries.property.in_(properties), is_measurable(entries.value_si), viewer.of(recordings))
        .cte("measured")
    )
    keys = (values.c.property, values.c.head, values.c.setup_id, values.c.ground_truth)
    means = select(*keys, func.count().label("number"), func.avg(values.c.value_si).label("mean")).group_by(*keys)
    found = means.cte("means")
    off = values.c.value_si - found.c.mean
    columns = (*(found.c[key.name] for key in keys), found.c.number, found.c.mean)
    same = and_(*(key == found.c[key.name] for key in keys))
    return select(*columns, func.sum(off * off).label("squares")).join(values, same).group_by(*columns)


def is_measurable(value_si: ColumnElement[Any]) -> ColumnElement[bool]:
    """The condition that a number is there and such as a measurement gives, so that its square is a number too."""
    return and_(value_si.is_not(None), value_si.between(-LARGEST_SI, LARGEST_SI))


def _results(connection: Connection, viewer: Viewer, things: Mapping[int, tuple[str, str]]) -> Iterator[Result]:
    """Results of objects by their rows, each with the dataset and the name under which it counts."""
    entries, recordings = schema.entries.c, schema.recordings
    numbers = (entries.value, entries.sd, entries.low, entries.high, entries.value_si, entries.sd_si)
    asked = (
        select(recordings.c.uuid, recordings.c.recorded_us, recordings.c.action, recordings.c.ground_truth)
        .add_columns(recordings.c.owner, recordings.c.thing_id, recordings.c.setup_id)
        .add_columns(entries.kind, entries.property, entries.unit, entries.label, *numbers)
        .join(schema.entries, entries.recording_id == recordings.c.id)
        # an index gives the recordings of an object in order, and none its entries
        .where(recordings.c.thing_id.in_(things), viewer.of(recordings))
        .order_by(recordings.c.recorded_us, recordings.c.id, entries.position)
    )
    units = deciding_units(connection)
    rows = connection.execute(asked).all()
    named = _names_of_setups(connection, {row.setup_id for row in rows})
    scale_of = lru_cache(_scale)
    for uuid, at_us, action, truth, owner, thing, setup, kind, property, unit, label, *values in rows:
        if setup not in named:
            continue
        unit_told = units.get(property or "")
        by, told = scale_of(unit, unit_told), values[:4]
        if by is None and values[4] is not None:
            # the unit was known when the number was kept
            by, told = _from_si(unit_told), [*values[4:], None, None]
        value, sd, low, high = (_told(one, by) for one in told)
        yield Result(
            recording=UUID(bytes=uuid),
            recorded_at=moment_at(at_us),
            action=action,
            ground_truth=bool(truth),
            dataset=things[thing][0],
            thing=things[thing][1],
            kind=kind,
            property=property,
            value=value,
            sd=sd,
            low=low,
            high=high,
            unit=None if by is None else unit_told,
            given=None if by is not None else Given(values[0], values[2], values[3], unit),
            label=label,
            owner=owner,
            measured_by=named[setup],
        )


def _told(value: float | None, by: float | None) -> float | None:
    """A number in another unit; None where there is none, or one that no measurement gives, as for `is_measurable`."""
    told = None if by is None or value is None else value * by
    return None if told is None or abs(told) > LARGEST_SI else told


def _scale(unit: str | None, told: str | None) -> float | None:
    # what is known to be wrong is kept in the unit in which it was given
    return None if unit is None or told is None else scale(unit, told)


def _from_si(told: str | None) -> float | None:
    factor = None if told is None else factor_of(told)
    return None if factor is None else 1 / factor


def _heads(connection: Connection, thing: ThingRef) -> dict[int, tuple[str, str]]:
    """Rows of an object and of those merged into it, each with the dataset and the name under which it counts."""
    things, head = schema.things, schema.things.alias("head")
    asked = (
        select(things.c.id, things.c.dataset, things.c.name, head.c.dataset, head.c.name)
        .join(head, head.c.id == things.c.merged_into, isouter=True)
        .where(things.c.id.in_(rows_of(thing)))
    )
    return {row: (of or dataset, called or name) for row, dataset, name, of, called in connection.execute(asked)}


def _names_of_setups(connection: Connection, rows: Collection[int]) -> dict[int, str]:
    setups = schema.setups
    asked = select(setups).where(setups.c.id.in_(rows))
    return {row.id: measured_by(setup_of(row.digest, row.document)) for row in connection.execute(asked)}


def measured_by(setup: Setup) -> str:
    """The name of what a result is said to be measured by: the gripper, or the first device that there is."""
    named = (setup.gripper, setup.arm, setup.camera, setup.microphone, *setup.other)
    return next((device.name for device in named if device is not None), "nothing that is named")
