"""Names that a store has never heard: where nothing matches a filter, one of them may be mistyped."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass

from sqlalchemy import Column, Connection, Select, select

from palpate.store import schema
from palpate.store.filters import Filter
from palpate.store.legible import reading
from palpate.store.store import Store

__all__ = ["Unknown", "unknown_names"]


@dataclass(frozen=True)
class Unknown:
    """A name that nothing in a store has.

    Attributes
    ----------
    field
        Of the filter.
    name
        What was asked for.
    what
        What it would be the name of.
    known
        The names that there are.
    """

    field: str
    name: str
    what: str
    known: tuple[str, ...]


def unknown_names(store: Store, wanted: Filter) -> Iterator[Unknown]:
    """The names in a filter that nothing in the store has, each with those that there are.

    It reads whole columns where there is no index, so it is for when nothing was found.

    Examples
    --------
    >>> from palpate.store.opening import open_store
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, open_store(f"{folder}/names.sqlite") as store:
    ...     [(one.what, one.name) for one in unknown_names(store, Filter(action="squeezing"))]
    [('action', 'squeezing')]
    """
    recordings, devices, things = schema.recordings.c, schema.devices.c, schema.things.c
    with reading(store.engine) as connection:
        if wanted.thing is not None:
            yield from _missing("thing", wanted.thing, "object", _things_called(connection))
        for name, what, column in (
            ("dataset", "dataset", things.dataset),
            ("action", "action", recordings.action),
            ("owner", "owner", recordings.owner),
            ("gripper", "gripper", recordings.gripper),
            ("device", "device", devices.name),
        ):
            found = getattr(wanted, name)
            if found is not None:
                yield from _missing(name, found, what, _names(connection, column))
        yield from _unknown_results(connection, wanted)


def _unknown_results(connection: Connection, wanted: Filter) -> Iterator[Unknown]:
    """Properties and labels: of results, and of what is known of objects."""
    results, known = schema.entries.c, schema.thing_properties.c
    if wanted.property is not None:
        yield from _missing("property", wanted.property, "property", _names(connection, results.property))
    for field, tables in (("labels", (results,)), ("known", (results, known))):
        for name, label in getattr(wanted, field).items():
            unknown = [*_missing(field, name, "property", _names(connection, *(table.property for table in tables)))]
            labels = (select(table.label).where(table.property == name) for table in tables)
            yield from unknown or _missing(field, label, f"label of {name}", _texts(connection, *labels))


def _things_called(connection: Connection) -> set[str]:
    """Whatever objects are called."""
    columns = schema.things.c
    names = set[str]()
    for dataset, name, common, aliases in connection.execute(
        select(columns.dataset, columns.name, columns.common_name, columns.aliases)
    ):
        names |= {name, f"{dataset}/{name}", *json.loads(aliases), *([common] if common else [])}
    return names


def _missing(field: str, name: str, what: str, known: set[str]) -> Iterator[Unknown]:
    if name not in known:
        yield Unknown(field, name, what, tuple(sorted(known)))


def _names(connection: Connection, *columns: Column[str]) -> set[str]:
    return _texts(connection, *(select(column) for column in columns))


def _texts(connection: Connection, *asked: Select[str]) -> set[str]:
    """What the columns hold, each once."""
    return {text for one in asked for text in connection.scalars(one.distinct()) if text}
