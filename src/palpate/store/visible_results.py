"""Results that somebody may see, each with what measured it: for plots and tables of one or several objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from sqlalchemy import select

from palpate.network.units import unit_of
from palpate.store import schema
from palpate.store.fetching import setup_of
from palpate.store.legible import reading
from palpate.store.records import Setup, ThingRef
from palpate.store.rows import EPOCH
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_things import rows_of

__all__ = ["Result", "results_of", "results_of_property"]


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


def results_of_property(store: Store, viewer: Viewer, property: str, *, limit: int = 20_000) -> tuple[Result, ...]:
    """The results of a property, the first measured first; of the last ones where there are more than `limit`."""
    return tuple(_results(store, viewer, schema.entries.c.property == property, limit))


def _results(store: Store, viewer: Viewer, condition: Any, limit: int | None = None) -> Iterator[Result]:
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
        .limit(limit)
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
