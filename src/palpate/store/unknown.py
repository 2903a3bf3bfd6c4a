"""Names that a store has never heard: where nothing matches a filter, one of them may be mistyped."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import Column, Connection, Select, select

from palpate.store import schema
from palpate.store.filters import Filter, each_label
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
    """Properties and labels: of results, or of what is known of objects, which what was only measured is not."""
    results, said, recordings = schema.entries.c, schema.thing_properties.c, schema.recordings.c
    if wanted.property is not None:
        yield from _missing("property", wanted.property, "property", _names(connection, results.property))
    measured = select(results.property, results.label)
    # as `Filter.known` finds them
    truths = measured.join(schema.recordings, recordings.id == results.recording_id).where(recordings.ground_truth)
    told = select(said.property, said.label)
    for field, kind, asked in (("labels", "", (measured,)), ("known", "known ", (truths, told))):
        for name, label in each_label(getattr(wanted, field)):
            there = _labels(connection, asked)
            unknown = [*_missing(field, name, f"{kind}property", set(there))]
            yield from unknown or _missing(field, label, f"{kind}label of {name}", there[name])


def _labels(connection: Connection, asked: Sequence[Select[str, str]]) -> Mapping[str, set[str]]:
    """Each property in the columns with its labels."""
    found = defaultdict[str, set[str]](set)
    for one in asked:
        for name, label in connection.execute(one.distinct()):
            if name:
                found[name].update({label} - {None, ""})
    return found


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


def _names(connection: Connection, column: Column[str]) -> set[str]:
    """What a column holds, each once."""
    return {text for text in connection.scalars(select(column).distinct()) if text}
