"""What a store knows of its objects: from people and data sheets, and from recordings that are known to be true."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from sqlalchemy import select

from palpate.fitting.data import true_value
from palpate.fitting.errors import FittingError
from palpate.fitting.gathering import Gathered
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, Property
from palpate.store import schema
from palpate.store.decoding import entry_from
from palpate.store.entries import Distribution, Entry, FailedEntry, Value
from palpate.store.legible import reading
from palpate.store.seals import sealed_document
from palpate.store.store import Store

__all__ = ["CERTAIN", "Known", "known_properties", "truth_of"]

CERTAIN = 0.99
"""A label of at least this probability counts as known."""


@dataclass(frozen=True)
class Known:
    """A known property of an object: the row of the object that it counts as, and the entry."""

    thing: int
    entry: Entry


def known_properties(store: Store) -> Iterator[Known]:
    """All that is known of objects to be true; what is known of one merged into another counts as of that one."""
    things, known, recordings = schema.things.c, schema.thing_properties.c, schema.recordings.c
    with reading(store.engine) as connection:
        heads = {row.id: row.merged_into or row.id for row in connection.execute(select(things.id, things.merged_into))}
        for thing, document in connection.execute(select(known.thing_id, known.document).order_by(known.id)):
            yield Known(heads[thing], entry_from(json.loads(document)))
        columns = [recordings[name] for name in ("thing_id", "uuid", "digest", "document", "seal")]
        true = select(*columns, things.dataset, things.name).outerjoin(schema.things, things.id == recordings.thing_id)
        for row in connection.execute(true.where(recordings.ground_truth).order_by(recordings.id)).mappings():
            for entry in sealed_document(row)["entries"]:
                yield Known(heads[row["thing_id"]], entry_from(entry))


def truth_of(gathered: Gathered, known: Iterable[Known]) -> Mapping[int, Mapping[str, str | float]]:
    """The known properties of each object, in the network's units; what is left out is told.

    Of several numbers of one property the median counts; labels must agree.
    """
    network = gathered.network
    found: dict[tuple[int, str], list[str | float]] = defaultdict(list)
    for one in known:
        prop = _property_of(network, one.entry)
        if prop is None:
            continue
        try:
            value = _value_of(prop, one.entry)
        except FittingError as error:
            gathered.tell(f"known {prop.name}: {error}; left out")
        else:
            found[one.thing, prop.name].append(value)
    truth: dict[int, dict[str, str | float]] = defaultdict(dict)
    for (thing, name), values in found.items():
        agreed = _agreed(values)
        if agreed is None:
            gathered.tell(f"known {name}: contradicting labels of one object; left out")
        else:
            truth[thing][name] = agreed
    return truth


def _property_of(network: Network, entry: Entry) -> Property | None:
    """The property that an entry is about; None where it is none of the network's, or nothing came of it."""
    return None if isinstance(entry, FailedEntry) else network.properties.get(entry.property)


def _value_of(prop: Property, entry: Entry) -> str | float:
    if isinstance(prop, CategoricalProperty) and isinstance(entry, Distribution):
        label, probability = max(entry.probabilities.items(), key=lambda item: item[1])
        if probability < CERTAIN:
            raise FittingError(f"found no label with a probability of at least {CERTAIN}")
        return true_value(prop, label)
    if isinstance(prop, CategoricalProperty) or not isinstance(entry, Value):
        wanted = "labels" if isinstance(prop, CategoricalProperty) else "a value"
        raise FittingError(f"found {type(entry).__name__.lower()}; expected {wanted}")
    if entry.unit is None:
        raise FittingError("found a value without a unit")
    return true_value(prop, entry.value, entry.unit)


def _agreed(values: Sequence[str | float]) -> str | float | None:
    numbers = [value for value in values if not isinstance(value, str)]
    if numbers:
        return float(median(numbers))
    return values[0] if len(set(values)) == 1 else None
