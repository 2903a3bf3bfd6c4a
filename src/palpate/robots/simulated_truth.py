"""What is true of a simulated object, told to the store that keeps what was measured of it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from palpate.network.model import KnownObject, Network
from palpate.network.units import UnitError, factor
from palpate.store.audit import CHANGED, history
from palpate.store.describing import add_thing, change_thing
from palpate.store.entries import Distribution, Entry, Value
from palpate.store.errors import StoreError
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing

__all__ = ["LOOKS_LIKE", "SOURCE", "simulated_thing", "tell_truth"]

SOURCE = "the simulation"
"""From where the truth is known."""
LOOKS_LIKE = "looks_like"
"""Attribute of an object that looks like another one."""


def simulated_thing(dataset: str, known: KnownObject) -> ThingRef:
    """The object as a store has it; of a trick its attributes say what it looks like."""
    return ThingRef(dataset, known.name, attributes={} if known.looks_like is None else {LOOKS_LIKE: known.looks_like})


def tell_truth(store: Store, thing: ThingRef, known: KnownObject, network: Network, *, who: str | None = None) -> None:
    """Let a store know what is true of a simulated object, so that sensors can be calibrated from it.

    Stand-ins are no truth. What was told before, and changed or taken back since, is not told again.

    Parameters
    ----------
    thing
        The object in the store, which is added if it is not there.
    known
        The object as it is simulated.
    who
        Who explores, for the audit.

    Raises
    ------
    StoreError
        Something else was simulated under that name before: then what is in the store cannot be told apart.
    """
    add_thing(store, thing, who=who)
    told = {tuple(part["field"]) for one in history(store, thing) if one.what == CHANGED for part in one.detail}

    def knowing(found: Thing) -> Thing:
        for entry in _entries(known, network):
            _check_same(found, entry, network)
            if ("known", entry.property, SOURCE) not in told:
                found = found.knowing(entry, SOURCE)
        return found

    change_thing(store, thing, knowing, who=who)


def _entries(known: KnownObject, network: Network) -> Iterator[Entry]:
    for name, true in known.truth.items():
        if not true.scored or name not in network.properties:
            continue
        if isinstance(true.value, str):
            yield Distribution(name, {true.value: 1.0})
        else:
            yield Value(name, true.value, unit=getattr(network.property(name), "unit", None))


def _check_same(found: Thing, entry: Entry, network: Network) -> None:
    for one in found.known:
        if (one.entry.property, one.source) == (entry.property, SOURCE) and not _is_same(one.entry, entry):
            raise StoreError(
                f"{found.path}: {entry.property} of what was simulated before is {_words(one.entry)}, and network "
                f"{network.name!r} has {_words(entry)}; expected the same object, or another store"
            )


def _is_same(before: Entry, now: Entry) -> bool:
    if not (isinstance(before, Value) and isinstance(now, Value)):
        return before == now
    try:
        return math.isclose(before.value * factor(before.unit or "", now.unit or ""), now.value, rel_tol=1e-9)
    except UnitError:
        return False


def _words(entry: Entry) -> str:
    match entry:
        case Distribution(_, probabilities):
            return max(probabilities, key=probabilities.__getitem__)
        case Value(_, value, _, unit):
            return f"{value:g} {unit}"
    return str(entry)
