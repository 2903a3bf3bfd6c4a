"""Actions, devices, setups and properties that somebody may see, because a recording of theirs is seen."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import CTE, Select, Table, exists, func, literal, select, union_all

from palpate.store import schema
from palpate.store.fetching import setup_of
from palpate.store.legible import reading
from palpate.store.records import Device, Setup
from palpate.store.seals import checked_document
from palpate.store.store import Store
from palpate.store.units import deciding_units
from palpate.store.viewing import Viewer

__all__ = [
    "Choices",
    "SeenDevice",
    "SeenProperty",
    "SeenSetup",
    "gripper_names",
    "result_counts",
    "seen_choices",
    "seen_devices",
    "seen_grippers",
    "seen_properties",
    "seen_setups",
]


@dataclass(frozen=True)
class Choices:
    """Names by which recordings can be found."""

    actions: tuple[str, ...]
    properties: tuple[str, ...]
    grippers: tuple[str, ...]


@dataclass(frozen=True)
class SeenSetup:
    """A setup and the number of recordings that are seen of it."""

    digest: str
    setup: Setup
    recordings: int


@dataclass(frozen=True)
class SeenDevice:
    """A device, the setups that it is part of, and the number of recordings that are seen of it."""

    digest: str
    device: Device
    setups: tuple[str, ...]
    recordings: int


@dataclass(frozen=True)
class SeenProperty:
    """A property with the unit that it was first given in (None for labels)."""

    name: str
    unit: str | None


def seen_choices(store: Store, viewer: Viewer) -> Choices:
    """All that recordings which are seen can be found by; the first that is seen is enough to know.

    It is one question, as each takes a database time to plan.
    """
    kinds = {
        "actions": _action_names(viewer),
        "properties": [_property_names(viewer)],
        "grippers": [gripper_names(viewer)],
    }
    asked = [select(literal(kind), one.subquery().columns[0]) for kind, some in kinds.items() for one in some]
    found: dict[str, set[str]] = {kind: set() for kind in kinds}
    with reading(store.engine) as connection:
        for kind, name in connection.execute(union_all(*asked)):
            found[kind].add(name)
    return Choices(**{kind: tuple(sorted(names)) for kind, names in found.items()})


def _action_names(viewer: Viewer) -> Iterator[Select[str]]:
    recordings = schema.recordings
    # the index of actions begins with this
    for known in (False, True):
        names = _each_value(recordings, "action", ground_truth=known)
        of_it = recordings.c.ground_truth == known, recordings.c.action == names.c.value
        yield select(names.c.value).where(names.c.value.is_not(None), exists().where(*of_it, viewer.of(recordings)))


def seen_setups(store: Store, viewer: Viewer, digest: bytes | None = None) -> tuple[SeenSetup, ...]:
    """All setups, the most used first; or the one of a digest."""
    counts, setups = _counts(viewer).subquery(), schema.setups.c
    asked = select(setups.digest, setups.document, counts.c.count).join(counts, counts.c.setup_id == setups.id)
    if digest is not None:
        asked = asked.where(setups.digest == digest)
    with reading(store.engine) as connection:
        rows = connection.execute(asked.order_by(counts.c.count.desc(), setups.id)).all()
        return tuple(SeenSetup(row[0].hex(), setup_of(row[0], row[1]), row[2]) for row in rows)


def seen_devices(store: Store, viewer: Viewer) -> tuple[SeenDevice, ...]:
    """All devices, by kind, name and date of calibration."""
    counts, links, devices, setups = _counts(viewer).subquery(), schema.setup_devices.c, schema.devices.c, schema.setups
    asked = (
        select(devices.digest, devices.document, setups.c.digest, counts.c.count)
        .join(links.device_id.table, links.device_id == devices.id)
        .join(counts, counts.c.setup_id == links.setup_id)
        .join(setups, setups.c.id == links.setup_id)
        .order_by(devices.kind, devices.name, devices.calibrated_on, devices.id)
    )
    groups: dict[tuple[bytes, str], list[tuple[str, int]]] = defaultdict(list)
    with reading(store.engine) as connection:
        for digest, document, setup, count in connection.execute(asked):
            groups[digest, document].append((setup.hex(), count))
        return tuple(
            SeenDevice(digest.hex(), _device(digest, document), tuple(one for one, _ in of), sum(n for _, n in of))
            for (digest, document), of in groups.items()
        )


def seen_grippers(store: Store, viewer: Viewer) -> tuple[str, ...]:
    """Names of all grippers with which something was measured that is seen."""
    with reading(store.engine) as connection:
        return tuple(sorted(connection.scalars(gripper_names(viewer))))


def gripper_names(viewer: Viewer) -> Select[str]:
    """The question that `seen_grippers` asks."""
    setups, recordings = schema.setups.c, schema.recordings
    # there are few setups, and each has its recordings together
    is_seen = exists().where(recordings.c.setup_id == setups.id, viewer.of(recordings))
    return select(setups.gripper).where(setups.gripper.is_not(None), is_seen).distinct()


def seen_properties(store: Store, viewer: Viewer) -> tuple[SeenProperty, ...]:
    """All properties of which a result is seen, by name; the first that is seen is enough to know."""
    with reading(store.engine) as connection:
        units = deciding_units(connection)
        found = sorted(connection.scalars(_property_names(viewer)))
    return tuple(SeenProperty(name, units.get(name)) for name in found)


def _property_names(viewer: Viewer) -> Select[str]:
    names, entries, recordings = _each_value(schema.entries, "property"), schema.entries.c, schema.recordings
    asked = select(names.c.value).where(names.c.value.is_not(None))
    if viewer.everything:
        return asked
    result = entries.property.table.join(recordings, recordings.c.id == entries.recording_id)
    is_seen = exists().select_from(result).where(entries.property == names.c.value, viewer.of(recordings))
    return asked.where(is_seen)


def result_counts(store: Store, viewer: Viewer) -> dict[str, int]:
    """How many results are seen of each property."""
    entries, recordings = schema.entries.c, schema.recordings
    asked = select(entries.property, func.count()).where(entries.property.is_not(None)).group_by(entries.property)
    if not viewer.everything:
        asked = asked.where(exists().where(recordings.c.id == entries.recording_id, viewer.of(recordings)))
    with reading(store.engine) as connection:
        return {name: count for name, count in connection.execute(asked) if name is not None}


def _each_value(table: Table, column: str, **same: object) -> CTE:
    """Each value of a column, by going from one to the next in an index; `same`: what stands before it there."""
    following = table.alias("following").c
    first = select(func.min(table.c[column]).label("value")).where(
        *(table.c[name] == one for name, one in same.items())
    )
    values = first.cte("_".join(("every", column, *map(str, same.values()))), recursive=True)
    next_ = select(func.min(following[column])).where(*(following[name] == one for name, one in same.items()))
    next_ = next_.where(following[column] > values.c.value)
    return values.union_all(select(next_.scalar_subquery()).where(values.c.value.is_not(None)))


def _device(digest: bytes, document: str) -> Device:
    return Device(**checked_document("devices", digest, document))


def _counts(viewer: Viewer) -> Select[int, int]:
    columns = schema.recordings.c
    asked = select(columns.setup_id, func.count().label("count")).where(viewer.of(schema.recordings))
    return asked.group_by(columns.setup_id)
