"""Results that somebody may see, each with what measured it: for plots and tables of one or several objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from sqlalchemy import Select, and_, func, select

from palpate.network.units import unit_of
from palpate.store import schema
from palpate.store.fetching import setup_of
from palpate.store.legible import reading
from palpate.store.records import Setup, ThingRef
from palpate.store.rows import EPOCH
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_things import rows_of

__all__ = ["Group", "Result", "groups_of_property", "results_of"]


@dataclass(frozen=True)
class Result:
    """One result.

    Attributes
    ----------
    value, sd, unit
        In the unit that the property was first given in; None where it is no number with a unit.
    low, high
        Ends of an interval or a bound, likewise.
    label
        The most probable label.
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
    label: str | None
    measured_by: str


def results_of(store: Store, viewer: Viewer, thing: ThingRef) -> tuple[Result, ...]:
    """All results of an object and of those merged into it, the first measured first."""
    return tuple(_results(store, viewer, schema.entries.c.thing_id.in_(rows_of(thing))))


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


def groups_of_property(store: Store, viewer: Viewer, property: str) -> tuple[str, tuple[Group, ...]]:
    """The unit of a property, and its values by object, setup, and whether they are known to be true.

    What was measured of objects merged into another one counts as that one's.
    """
    setups, things = schema.setups, schema.things
    groups = _groups(viewer, property).subquery()
    asked = (
        select(groups, setups.c.digest, setups.c.document, things.c.dataset, things.c.name)
        .join(setups, setups.c.id == groups.c.setup_id)
        .join(things, things.c.id == groups.c.head)
    )
    with reading(store.engine) as connection:
        unit = connection.scalar(select(schema.properties.c.unit).where(schema.properties.c.name == property)) or ""
        rows = connection.execute(asked).all()
        scale = unit_of(unit).factor if rows else 1.0
        return unit, tuple(
            Group(
                dataset=row.dataset,
                thing=row.name,
                measured_by=_measured_by(setup_of(row.digest, row.document)),
                ground_truth=bool(row.ground_truth),
                count=row.number,
                mean=row.mean / scale,
                squares=row.squares / scale**2,
            )
            for row in rows
        )


def _groups(viewer: Viewer, property: str) -> Select[*tuple[Any, ...]]:
    """Head, setup, truth, count, mean and squares; the mean first, so that no digits are lost in the squares."""
    entries, recordings, things = schema.entries.c, schema.recordings, schema.things
    head = func.coalesce(things.c.merged_into, things.c.id)
    values = (
        select(head.label("head"), entries.setup_id, recordings.c.ground_truth, entries.value_si)
        .join(recordings, recordings.c.id == entries.recording_id)
        .join(things, things.c.id == entries.thing_id)
        .where(entries.property == property, entries.value_si.is_not(None), viewer.of(recordings))
        .cte("measured")
    )
    keys = (values.c.head, values.c.setup_id, values.c.ground_truth)
    means = select(*keys, func.count().label("number"), func.avg(values.c.value_si).label("mean")).group_by(*keys)
    found = means.cte("means")
    off = values.c.value_si - found.c.mean
    columns = (*(found.c[key.name] for key in keys), found.c.number, found.c.mean)
    same = and_(*(key == found.c[key.name] for key in keys))
    return select(*columns, func.sum(off * off).label("squares")).join(values, same).group_by(*columns)


def _results(store: Store, viewer: Viewer, condition: Any) -> Iterator[Result]:
    entries, recordings, things, setups = schema.entries, schema.recordings, schema.things, schema.setups
    head = things.alias("head")
    asked = (
        select(
            entries,
            recordings.c.uuid,
            recordings.c.action,
            recordings.c.ground_truth,
            setups.c.digest.label("setup_digest"),
            setups.c.document.label("setup"),
            head.c.dataset,
            head.c.name.label("thing"),
        )
        .join(recordings, recordings.c.id == entries.c.recording_id)
        .join(setups, setups.c.id == entries.c.setup_id)
        .join(things, things.c.id == entries.c.thing_id)
        .join(head, head.c.id == things.c.merged_into, isouter=True)
        .where(condition, viewer.of(recordings))
        .order_by(entries.c.recorded_us.desc(), entries.c.recording_id.desc(), entries.c.position.desc())
        .add_columns(things.c.dataset.label("own_dataset"), things.c.name.label("own_name"))
    )
    with reading(store.engine) as connection:
        units = {row.name: row.unit for row in connection.execute(select(schema.properties))}
        rows = connection.execute(asked).mappings().all()
        for row in reversed(rows):
            named = _measured_by(setup_of(row["setup_digest"], row["setup"]))
            yield _result(row, units.get(row["property"] or ""), named)


def _result(row: Mapping[Any, Any], unit: str | None, measured_by: str) -> Result:
    scale = None
    if row["unit"] is not None and unit is not None:
        scale = unit_of(row["unit"]).factor / unit_of(unit).factor
    numbers: dict[str, Any] = {
        name: None if scale is None or row[name] is None else row[name] * scale for name in NUMBERS
    }
    same = ("action", "kind", "property", "label")
    return Result(
        recording=UUID(bytes=row["uuid"]),
        recorded_at=EPOCH + timedelta(microseconds=row["recorded_us"]),
        ground_truth=bool(row["ground_truth"]),
        dataset=row["dataset"] or row["own_dataset"],
        thing=row["thing"] or row["own_name"],
        unit=None if scale is None else unit,
        measured_by=measured_by,
        **numbers,
        **{name: row[name] for name in same},
    )


NUMBERS = ("value", "sd", "low", "high")


def _measured_by(setup: Setup) -> str:
    named = (setup.gripper, setup.arm, setup.camera, setup.microphone, *setup.other)
    return next((device.name for device in named if device is not None), "nothing that is named")
