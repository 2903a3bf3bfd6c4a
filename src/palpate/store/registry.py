"""What many recordings share and is kept once: objects, setups with their devices, layouts, units of properties."""

from __future__ import annotations

import json
import time
from collections import ChainMap
from collections.abc import Hashable, Iterator, Mapping, MutableMapping
from hashlib import sha256
from itertools import islice
from typing import Any

from sqlalchemy import Connection, Table, insert, select, update

from palpate.store import schema
from palpate.store.checks import check_thing, check_unit_of
from palpate.store.completing import contradictions, joined_things, taken_away, without
from palpate.store.content import device_plain, setup_plain, to_json
from palpate.store.entries import Bound, Interval, Value
from palpate.store.errors import DamagedError, StoreError
from palpate.store.legible import legible
from palpate.store.records import Device, Recording, Setup, ThingRef

__all__ = ["Lookup", "NotRememberedError", "Registry", "now_us", "units_in"]

MEASURED = (Value, Interval, Bound)
MOST_REMEMBERED = 10_000
"""Rows of which a store knows the numbers without looking."""
Key = tuple[str, Hashable]


def now_us() -> int:
    """The present in microseconds since 1970."""
    return time.time_ns() // 1000


def units_in(recording: Recording) -> Iterator[tuple[int, tuple[str, str]]]:
    """Place of each result that has a unit, its property and the unit."""
    for place, entry in enumerate(recording.entries):
        if isinstance(entry, MEASURED) and entry.unit is not None:
            yield place, (entry.property, entry.unit)


class NotRememberedError(Exception):
    """What a recording refers to is not remembered: a `Lookup` finds or makes it."""


class Registry:
    """Row numbers of what recordings share.

    What was found is remembered: these rows are never removed. As a transaction may still fail, only `Lookup.keep`
    fills it. Where something is not remembered each method raises NotRememberedError.
    """

    def __init__(self) -> None:
        self.remembered: dict[Key, int] | ChainMap[Key, int] = {}

    def layout(self, layout: str) -> int:
        """The row of a layout of series."""
        return self.remembered.get(_key("layout", layout)) or self._new_layout(layout)

    def setup(self, setup: Setup) -> int:
        """The row of a setup."""
        return self.remembered.get(("setup", setup.digest)) or self._new_setup(setup)

    def thing(self, thing: ThingRef) -> int:
        """The row of an object; a description that says more than the one there completes it."""
        return self.remembered.get(_thing_key(thing)) or self._new_thing(thing)

    def description(self, thing: ThingRef) -> int | None:
        """The row of what a recording says of its object; None where that is its dataset and its name only."""
        if not said_of(thing):
            return None
        return self.remembered.get(_description_key(thing)) or self._new_description(thing)

    def admit_units(self, recording: Recording, known: MutableMapping[str, str], *, is_known_wrong: bool) -> None:
        """Refuse units of another dimension than their property has; those of new properties decide theirs.

        Parameters
        ----------
        known
            Property to the unit that decides, as the store has it in this transaction: it may have been changed since
            the last one. What is new is added.
        is_known_wrong
            Whether units of another dimension are let in, as these results are known not to count.

        Raises
        ------
        StoreError
            Naming the entry.
        """
        for place, (name, unit) in units_in(recording):
            where = f"entries[{place}].unit"
            if name not in known:
                self.admit_unit(where, name, unit)
                known[name] = unit
            elif unit != known[name] and not is_known_wrong:
                check_unit_of(where, name, unit, known[name])

    def _new_layout(self, layout: str) -> int:
        raise NotRememberedError

    def _new_setup(self, setup: Setup) -> int:
        raise NotRememberedError

    def _new_thing(self, thing: ThingRef) -> int:
        raise NotRememberedError

    def _new_description(self, thing: ThingRef) -> int:
        raise NotRememberedError

    def admit_unit(self, where: str, name: str, unit: str) -> None:
        """Refuse a unit of another dimension than a property was first given in; StoreError begins with `where`."""
        raise NotRememberedError


class Lookup(Registry):
    """What recordings share, found or made in one transaction; `keep` remembers it once that is committed."""

    def __init__(self, connection: Connection, registry: Registry) -> None:
        super().__init__()
        self.connection = connection
        self.registry = registry
        self.found: dict[Key, int] = {}
        self.remembered = ChainMap(self.found, registry.remembered)

    def keep(self) -> None:
        """Remember what was found, and forget what was found first where that is too much."""
        remembered = self.registry.remembered
        remembered.update(self.found)
        for key in list(islice(remembered, max(0, len(remembered) - MOST_REMEMBERED))):
            del remembered[key]

    def _new_layout(self, layout: str) -> int:
        return self._kept(_key("layout", layout), self._by_digest(schema.layouts, layout, {}))

    def _new_setup(self, setup: Setup) -> int:
        return self._kept(("setup", setup.digest), self._make_setup(setup))

    def _new_thing(self, thing: ThingRef) -> int:
        return self._kept(_thing_key(thing), self._make_thing(thing))

    def _new_description(self, thing: ThingRef) -> int:
        return self._kept(_description_key(thing), self._make_description(thing))

    def _kept(self, key: Key, row: int) -> int:
        self.found[key] = row
        return row

    def admit_unit(self, where: str, name: str, unit: str) -> None:
        """Refuse a unit of another dimension than a property was first given in, and remember that of a new one."""
        known = self._unit(name)
        check_unit_of(where, name, unit, known)
        if known is None:
            self.connection.execute(insert(schema.properties), {"name": name, "unit": unit})

    def _unit(self, name: str) -> str | None:
        table = schema.properties.c
        return self.connection.execute(select(table.unit).where(table.name == name)).scalar()

    def _by_digest(self, table: Table, text: str, columns: Mapping[str, Any]) -> int:
        digest = sha256(text.encode()).digest()
        found = self.connection.execute(select(table.c.id).where(table.c.digest == digest)).scalar()
        return found or self._insert(table, {"digest": digest, "document": text, **columns})

    def _insert(self, table: Table, row: Mapping[str, Any]) -> int:
        made: int = self.connection.execute(insert(table).values(**row).returning(table.c.id)).scalar_one()
        return made

    def _make_setup(self, setup: Setup) -> int:
        table = schema.setups
        there = select(table.c.id).where(table.c.digest == bytes.fromhex(setup.digest))
        found: int | None = self.connection.execute(there).scalar()
        if found is not None:
            return found
        gripper = None if setup.gripper is None else setup.gripper.name
        made = self._by_digest(table, to_json(setup_plain(setup)), {"gripper": gripper})
        rows = [{"setup_id": made, "device_id": row} for row in sorted({self._device(one) for one in setup.devices})]
        if rows:
            self.connection.execute(insert(schema.setup_devices), rows)
        return made

    def _device(self, device: Device) -> int:
        named = ("kind", "name", "maker", "calibrated_on")
        columns = {name: getattr(device, name) for name in named}
        return self._by_digest(schema.devices, to_json(device_plain(device)), columns)

    def _make_thing(self, thing: ThingRef) -> int:
        table = schema.things
        # nobody else may change the description until this one is written; what refers to it may be put
        there = select(table).where(table.c.dataset == thing.dataset, table.c.name == thing.id)
        found = self.connection.execute(there.with_for_update(key_share=True)).mappings().first()
        if found is None:
            return self._insert(table, {"dataset": thing.dataset, "name": thing.id, **thing_row(thing)})
        known = thing_of(found)
        joined = joined_things(known, thing)
        if joined != known:
            with legible(f"the audit of object {known.dataset}/{known.id}"):
                joined = without(known, joined, taken_away(self.connection, found["id"]))
            self.connection.execute(update(table).where(table.c.id == found["id"]).values(**thing_row(joined)))
        contradicted = contradictions(known, thing)
        if contradicted:
            row = {"at_us": now_us(), "what": "described otherwise", "thing_id": found["id"]}
            self.connection.execute(insert(schema.audit).values(**row, detail=to_json(contradicted)))
        return int(found["id"])

    def _make_description(self, thing: ThingRef) -> int:
        table, row = schema.descriptions, {"thing_id": self.thing(thing), **description_row(thing)}
        same = (table.c[name] == row[name] for name in ("thing_id", "digest"))
        found: int | None = self.connection.execute(select(table.c.id).where(*same)).scalar()
        return found or self._insert(table, row)


def said_of(thing: ThingRef) -> list[str]:
    """What else than its name in a data set an object is called, and its maker."""
    return [text for text in (thing.common_name, *thing.aliases, thing.maker) if text]


def description_row(thing: ThingRef) -> dict[str, Any]:
    """What `schema.descriptions` holds of what a recording says of its object."""
    said = {name: value for name, value in thing_row(thing).items() if name != "attributes"}
    words = "\n".join(said_of(thing)).casefold()
    return {**said, "digest": sha256(to_json(said).encode()).digest(), "words": words}


def _description_key(thing: ThingRef) -> Key:
    return _key("description", repr((thing.dataset, thing.id, thing.maker, thing.common_name, tuple(thing.aliases))))


def _thing_key(thing: ThingRef) -> Key:
    """What tells an object, and its description, from others."""
    described = to_json(thing.attributes) if thing.attributes else ""
    names = (thing.dataset, thing.id, thing.maker, thing.common_name, tuple(thing.aliases), described)
    return _key("thing", repr(names))


def _key(kind: str, text: str) -> Key:
    """By what something is remembered; a text may be of any length."""
    return (kind, sha256(text.encode("utf-8", "surrogatepass")).digest())


def thing_of(row: Mapping[Any, Any]) -> ThingRef:
    """An object from its row.

    Raises
    ------
    DamagedError
        If there is none that could have been kept.
    """
    where = f"object {row['dataset']}/{row['name']}"
    names = (row["dataset"], row["name"], row["maker"], row["common_name"])
    with legible(where):
        thing = ThingRef(*names, json.loads(row["attributes"]), tuple(json.loads(row["aliases"])))
    try:
        # no digest covers it
        check_thing(thing)
    except StoreError as error:
        raise DamagedError(f"{where}: {error}") from None
    return thing


def thing_row(thing: ThingRef) -> dict[str, Any]:
    """What the tables hold of a description."""
    return {
        "maker": thing.maker,
        "common_name": thing.common_name,
        "attributes": to_json(thing.attributes),
        "aliases": to_json(list(thing.aliases)),
    }
