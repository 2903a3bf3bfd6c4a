"""The unit of each property of a store, which decides its dimension; and taking back one that was wrong."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import Connection, func, insert, null, select, text, update

from palpate.errors import choices, near
from palpate.store import schema
from palpate.store.checks import check_unit
from palpate.store.content import to_json
from palpate.store.database import changing
from palpate.store.decoding import entry_from
from palpate.store.errors import StoreError
from palpate.store.known_units import are_alike, factor_of
from palpate.store.legible import reading
from palpate.store.quantities import check_quantity
from palpate.store.registry import now_us
from palpate.store.store import Store
from palpate.store.texts import check_name

__all__ = ["PropertyUnit", "admit_units", "change_unit", "deciding_units", "list_units", "take_units", "units_of"]

UNIT = "unit"
"""What the audit calls the change of a property's unit."""


@dataclass(frozen=True)
class PropertyUnit:
    """A property of a store.

    Attributes
    ----------
    name, unit
        The property, and the unit that decides its dimension, in which means are given.
    results
        How many results in a unit there are that count.
    wrong
        How many there are in a unit of another dimension, which are kept and do not count.
    """

    name: str
    unit: str
    results: int
    wrong: int


def units_of(store: Store) -> Mapping[str, str]:
    """Property to its unit."""
    with reading(store.engine) as connection:
        return deciding_units(connection)


def deciding_units(connection: Connection) -> dict[str, str]:
    """Property to its unit."""
    return {row.name: row.unit for row in connection.execute(select(schema.properties))}


def list_units(store: Store) -> tuple[PropertyUnit, ...]:
    """All properties that have a unit, by name."""
    with reading(store.engine) as connection:
        units, given = deciding_units(connection), _given(connection)
    return tuple(_counted(name, unit, given.get(name, {})) for name, unit in sorted(units.items()))


def admit_units(store: Store, units: Mapping[str, str]) -> None:
    """Let units decide the dimension of properties that a store does not know; of the others nothing changes.

    Raises
    ------
    StoreError
        If one is unknown.
    """
    for name, unit in units.items():
        check_name("units", name)
        check_unit(f"units[{name!r}]", unit, None)
    take_units(store, units)


def take_units(store: Store, units: Mapping[str, str]) -> None:
    """As `admit_units`, from another store: its units need not be known here."""
    rows = [{"name": name, "unit": unit} for name, unit in units.items()]
    if rows:
        with changing(store.engine) as connection:
            connection.execute(
                text("INSERT INTO properties (name, unit) VALUES (:name, :unit) ON CONFLICT DO NOTHING"), rows
            )


def change_unit(store: Store, name: str, unit: str, *, wrong: bool = False, who: str | None = None) -> PropertyUnit:
    """Let another unit decide the dimension of a property, as where the first one was a mistake.

    No recording is changed: results in a unit of another dimension stay as they were given, and no longer count in
    means, as if nobody had stated their unit. Changed back, they count again. The audit holds who did it.

    Parameters
    ----------
    store
        Where it is.
    name
        The property.
    unit
        Any unit of the right dimension.
    wrong
        Whether the results that there are in a unit of another dimension are known to be wrong.
    who
        Who decided it.

    Raises
    ------
    StoreError
        If the store has no such property, the unit is unknown or is not one of what everybody knows, there are
        results in a unit of another dimension that are not said to be wrong, or that much is known of an object.

    Examples
    --------
    ::

        change_unit(store, "fluffiness", "kPa", wrong=True, who="ann")
    """
    check_unit("unit", unit, None)
    check_quantity("unit", unit, name)
    with changing(store.engine) as connection:
        if connection.dialect.name == "postgresql":
            # until this ends nobody may put results, as whoever does reads this table
            connection.execute(text("LOCK TABLE properties IN ACCESS EXCLUSIVE MODE"))
        units = deciding_units(connection)
        if name not in units:
            raise StoreError(f"property: {name!r} has no unit here{near(name, units)}; {choices(units)}")
        changed = _counted(name, unit, _given(connection, name).get(name, {}))
        if changed.wrong and not wrong:
            found = f"property {name!r}: {changed.wrong} of its results are in a unit of another dimension"
            raise StoreError(
                f"{found} than {unit!r}, expected none, or that they are said to be wrong (wrong, --wrong)"
            )
        _check_known(connection, name, unit)
        _count_anew(connection, name, unit)
        connection.execute(update(schema.properties).where(schema.properties.c.name == name).values(unit=unit))
        detail = {"property": name, "before": units[name], "after": unit, "results": changed.results + changed.wrong}
        note = {"at_us": now_us(), "who": who, "what": UNIT, "detail": to_json(detail)}
        connection.execute(insert(schema.audit).values(**note))
        return changed


def _given(connection: Connection, name: str | None = None) -> dict[str, dict[str, int]]:
    """How many results there are, by property and unit."""
    entries = schema.entries.c
    asked = select(entries.property, entries.unit, func.count()).where(entries.unit.is_not(None))
    if name is not None:
        asked = asked.where(entries.property == name)
    found: dict[str, dict[str, int]] = {}
    for property_, unit, count in connection.execute(asked.group_by(entries.property, entries.unit)):
        found.setdefault(property_, {})[unit] = count
    return found


def _counted(name: str, unit: str, given: Mapping[str, int]) -> PropertyUnit:
    right = sum(count for one, count in given.items() if are_alike(one, unit))
    return PropertyUnit(name, unit, right, sum(given.values()) - right)


def _check_known(connection: Connection, name: str, unit: str) -> None:
    """Refuse a unit of another dimension than what is known of objects is in; that can be told anew."""
    known, things = schema.thing_properties.c, schema.things.c
    asked = select(known.document, things.dataset, things.name).join(schema.things, things.id == known.thing_id)
    for document, dataset, thing in connection.execute(asked.where(known.property == name)):
        other = getattr(entry_from(json.loads(document)), "unit", None)
        if other is not None and not are_alike(other, unit):
            found = f"object {dataset}/{thing}: what is known of its {name} is in {other!r}"
            raise StoreError(f"{found}, expected a unit of the dimension of {unit!r}: forget it first")


def _count_anew(connection: Connection, name: str, unit: str) -> None:
    """Give the results of a property their values in SI units where their own unit has the dimension of this one."""
    entries = schema.entries
    here = entries.c.property == name
    for other in connection.scalars(select(entries.c.unit).where(here, entries.c.unit.is_not(None)).distinct()).all():
        scale = factor_of(other) if are_alike(other, unit) else None
        counts = {"value_si": entries.c.value * scale, "sd_si": entries.c.sd * scale} if scale is not None else None
        values = counts or dict.fromkeys(("value_si", "sd_si"), null())
        those = here, entries.c.unit == other, entries.c.kind == "value"
        connection.execute(update(entries).where(*those).values(**values))
