"""The undirected graph that messages travel on: nodes, transition tables, reference components."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import NetworkError
from palpate.inference.message_passing.mixture_fit import Mixture
from palpate.information import entropy_bits
from palpate.network.families import Normal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty

__all__ = ["Beliefs", "Graph", "Quotient", "read_graph"]

Array = NDArray[np.float64]
Beliefs = Mapping[str, Array]
"""Node to its probabilities (S,) or its density at the nodes of its grid (K,)."""

SHIPPED = Path(__file__).parents[2] / "data" / "actsel_tables.json"


@dataclass(frozen=True)
class Quotient:
    """How a reading of a derived property becomes one of a node.

    Parameters
    ----------
    target
        The continuous node that the reading is about: the derived property solved for it.
    unit
        The target's unit, in which the numbers below are.
    sd
        Noise of such a reading in terms of the target, for expected gains only [unit].
    limit
        Values of the target above it are dropped [unit].
    """

    target: str
    unit: str
    sd: float
    limit: float


@dataclass(frozen=True, eq=False)
class Graph:
    """Nodes, edges and tables.

    Parameters
    ----------
    children
        Node to its children, in the order in which messages are sent; an edge may stand at both ends.
    states
        Categorical node to its number of states.
    tables
        (sender, receiver) to the table T of the message T @ weights, receiver x sender; columns sum to one.
    mixtures
        Continuous node to its reference components, one per state of its only neighbour.
    quotients
        Derived property to what a reading of it means.
    """

    children: Mapping[str, tuple[str, ...]]
    states: Mapping[str, int]
    tables: Mapping[tuple[str, str], Array]
    mixtures: Mapping[str, Mixture]
    quotients: Mapping[str, Quotient] = field(default_factory=dict)

    @property
    def nodes(self) -> tuple[str, ...]:
        """All nodes."""
        return (*self.states, *self.mixtures)

    def neighbours(self, node: str) -> tuple[str, ...]:
        """Children, then parents."""
        parents = (name for name, children in self.children.items() if node in children)
        return tuple(dict.fromkeys((*self.children.get(node, ()), *parents)))

    @cached_property
    def prior(self) -> Beliefs:
        """Uniform probabilities, and mixtures with uniform weights.

        The part of a mixture beyond its grid is missing from it, as in the released program.
        """
        uniform = {name: np.full(count, 1 / count) for name, count in self.states.items()}
        mixed = {name: m.density(np.full(len(m.means), 1 / len(m.means))) for name, m in self.mixtures.items()}
        return {**uniform, **mixed}

    def entropy_bits(self, node: str, belief: Array) -> float:
        """Entropy of a belief about a node, differential for a continuous one [bits]."""
        return self.mixtures[node].grid.entropy_bits(belief) if node in self.mixtures else entropy_bits(belief)

    def normalised(self, node: str, belief: Array) -> Array:
        """The belief scaled to probability one; it is above zero somewhere."""
        total = self.mixtures[node].grid.integral(belief) if node in self.mixtures else belief.sum()
        return np.asarray(belief / total)

    def column_entropies(self, sender: str, receiver: str) -> Array:
        """Entropy of each column of a table [bits], an entry per state of the receiver (R,).

        A table that is not square is replaced by its product with its transpose, columns scaled to
        sum to one.
        """
        table = self.tables[sender, receiver]
        if table.shape[0] != table.shape[1]:
            table = table @ table.T
            table = table / table.sum(axis=0)
        return np.array([entropy_bits(column) for column in table.T])


def read_graph(network: Network, path: Path = SHIPPED) -> Graph:
    """The published graph with its tables, and the reference components of the network's densities.

    Raises
    ------
    NetworkError
        The network does not have the graph's properties with the same states.
    """
    found: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    states: Mapping[str, list[str]] = found["states"]
    children = {name: tuple(names) for name, names in found["children"].items()}
    quotients = {name: Quotient(**entry) for name, entry in found["quotients"].items()}
    problem = _misfit(network, states, children, quotients)
    if problem:
        known = " or ".join(repr(name) for name in found["networks"])
        raise NetworkError(
            f"network {network.name!r}: {problem}, but the message-passing engine has tables for the published "
            f"graph alone, expected the network {known}"
        )
    mixtures = {}
    for leaf in network.continuous:
        assert isinstance(leaf.family, Normal)
        mixtures[leaf.name] = Mixture.on_own_grid(leaf.family.mean, leaf.family.sd)
    return Graph(
        children=children,
        states={name: len(names) for name, names in states.items()},
        tables={(t["sender"], t["receiver"]): np.array(t["table"]) for t in found["tables"]},
        mixtures=mixtures,
        quotients=quotients,
    )


def _misfit(
    network: Network,
    states: Mapping[str, list[str]],
    children: Mapping[str, tuple[str, ...]],
    quotients: Mapping[str, Quotient],
) -> str | None:
    """In what a network differs from the graph; None where it fits."""
    leaves = {child: parent for parent, names in children.items() for child in names if child not in states}
    for name in (*states, *leaves, *quotients):
        if name not in network.properties:
            return f"it has no property {name!r}"
    for name, known in network.properties.items():
        if isinstance(known, CategoricalProperty) and known.states != tuple(states.get(name, ())):
            return f"property {name!r} has other states than the tables"
        if isinstance(known, ContinuousProperty) and (
            known.parents != (leaves.get(name),) or not isinstance(known.family, Normal)
        ):
            return f"property {name!r} is not a mixture of normals over the states of its neighbour in the graph"
        if isinstance(known, DerivedProperty) == (name in states or name in leaves):
            return f"property {name!r} is of another kind than its node in the graph"
    for quotient in quotients.values():
        if getattr(network.property(quotient.target), "unit", None) != quotient.unit:
            return f"property {quotient.target!r} is not in {quotient.unit}"
    return None
