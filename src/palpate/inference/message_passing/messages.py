"""Messages: from the measured node outwards, each node once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.inference.message_passing.graph import Beliefs, Graph
from palpate.inference.message_passing.mixture_fit import Mixture

__all__ = ["FitWeights", "Sent", "propagate"]

Array = NDArray[np.float64]
FitWeights = Callable[[Mixture, Array], Array]
"""Weights of the reference components in a density."""


@dataclass(frozen=True, eq=False)
class Sent:
    """One message and what became of its receiver.

    Parameters
    ----------
    message
        Over the receiver's states (S,), or a density at the nodes of its grid (K,).
    belief
        Of the receiver after it: old belief x message, normalised.
    """

    sender: str
    receiver: str
    message: Array
    belief: Array


def propagate(graph: Graph, beliefs: Beliefs, measured: str, fit: FitWeights) -> Iterator[Sent]:
    """Send messages breadth first from a node, over children and then parents, to each node once.

    Source: Kruzliak et al., IROS 2024. A receiver passes on its new belief, so that what it was told
    comes back to nobody; but what it believed before is passed on again with every measurement.

    Parameters
    ----------
    beliefs
        Of every node, that of the measured node as it is after the measurement.
    measured
        The node at which messages start.

    Yields
    ------
    Sent
        Each message in its order.
    """
    current = dict(beliefs)
    reached, senders = {measured}, [measured]
    for sender in senders:
        for receiver in graph.neighbours(sender):
            if receiver in reached:
                continue
            reached.add(receiver)
            senders.append(receiver)
            message = _message(graph, sender, receiver, current[sender], fit)
            current[receiver] = graph.normalised(receiver, current[receiver] * message)
            yield Sent(sender, receiver, message, current[receiver])


def _message(graph: Graph, sender: str, receiver: str, belief: Array, fit: FitWeights) -> Array:
    """What a node with that belief tells a neighbour."""
    if receiver in graph.mixtures:
        return graph.mixtures[receiver].density(belief)
    weights = fit(graph.mixtures[sender], belief) if sender in graph.mixtures else belief
    return np.asarray(graph.tables[sender, receiver] @ weights)
