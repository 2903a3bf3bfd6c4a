"""Expected entropies: what an action would leave of the uncertainty about every node, on average.

The method does not go through the outcomes one by one. It blurs the belief of the measured node as
the action's noise would, calls that the emulated belief, and sends messages from it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from palpate.inference.message_passing.graph import Beliefs, Graph
from palpate.inference.message_passing.messages import FitWeights, propagate
from palpate.information import entropy_bits

__all__ = ["blurred", "confused", "expected_entropies"]

Array = NDArray[np.float64]


def confused(table: Array, probabilities: Array) -> tuple[Array, float]:
    """The emulated belief after a label, and the expected entropy of it [bits].

    Source: Kruzliak et al., IROS 2024: with confusion matrix C and belief b, b x Cb normalised, and
    Σ_o (Cb)(o) H(C[:, o]). The columns of C are true states and are read as if they were beliefs.

    Parameters
    ----------
    table
        C, outcomes x states, both in the same order; columns sum to one.
    probabilities
        b (S,).

    Examples
    --------
    >>> emulated, bits = confused(np.array([[1.0, 0.5], [0.0, 0.5]]), np.array([0.5, 0.5]))
    >>> emulated.tolist(), bits
    ([0.75, 0.25], 0.25)
    """
    outcomes = table @ probabilities
    entropies = np.array([entropy_bits(column) for column in table.T])
    emulated = probabilities * outcomes
    return np.asarray(emulated / emulated.sum()), float(outcomes @ entropies)


def blurred(graph: Graph, node: str, density: Array, sd: float, times_belief: bool) -> tuple[Array, float]:
    """The emulated belief of a continuous node, and its entropy, taken as the expected one [bits].

    Parameters
    ----------
    sd
        Noise of the action [unit of the node].
    times_belief
        Whether the blurred density is multiplied by the density once more.
    """
    emulated = graph.mixtures[node].grid.blurred(density, sd)
    if times_belief:
        emulated = graph.normalised(node, emulated * density)
    return emulated, graph.entropy_bits(node, emulated)


def expected_entropies(
    graph: Graph, beliefs: Beliefs, measured: str, emulated: tuple[Array, float], fit: FitWeights
) -> Mapping[str, float]:
    """Expected entropy of every node that messages from an emulated belief reach [bits].

    Source: Kruzliak et al., IROS 2024. A categorical receiver: Σ message x entropy of the columns of
    the transition table; a continuous receiver: the entropy of belief x message.

    Parameters
    ----------
    emulated
        The measured node's emulated belief and expected entropy (`confused`, `blurred`).
    """
    belief, bits = emulated
    expected = {measured: bits}
    for sent in propagate(graph, {**beliefs, measured: belief}, measured, fit):
        if sent.receiver in graph.mixtures:
            expected[sent.receiver] = graph.entropy_bits(sent.receiver, sent.belief)
        else:
            entropies = graph.column_entropies(sent.sender, sent.receiver)
            expected[sent.receiver] = float(sent.message @ entropies)
    return expected
