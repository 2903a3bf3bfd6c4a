"""Which continuous properties of a network belong together, as formulas link them."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.inference.group import Group
from palpate.network.model import Network
from palpate.network.sensors import NumberSensor

__all__ = ["groups_of"]


def groups_of(network: Network) -> tuple[Group, ...]:
    """The groups of a network, in the order of their first members."""
    order = list(network.properties)
    found = sorted(_linked(network), key=lambda names: min(order.index(n) for n in names))
    return tuple(_group(network, names) for names in found)


def _linked(network: Network) -> Sequence[set[str]]:
    """Sets of continuous properties that formulas link."""
    found: list[set[str]] = [{p.name} for p in network.continuous]
    for derived in network.derived:
        touching = [names for names in found if names & set(derived.formula.variables)]
        found = [names for names in found if names not in touching] + [set().union(*touching)]
    return found


def _group(network: Network, names: set[str]) -> Group:
    bases = {p.name: p for p in network.continuous if p.name in names}
    derived = {d.name: d for d in network.derived if set(d.formula.variables) <= names}
    parents = tuple(c.name for c in network.categorical if any(c.name in b.parents for b in bases.values()))
    members = {*bases, *derived}
    sensors = [a.sensor for a in network.actions.values()]
    own = tuple(s for s in sensors if isinstance(s, NumberSensor) and s.property in members)
    return Group(bases, derived, parents, own)
