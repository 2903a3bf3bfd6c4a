"""What a measurement does to the belief of the node it is about, before any message."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.inference.message_passing.graph import Beliefs, Graph
from palpate.inference.message_passing.grid import Grid
from palpate.inference.message_passing.settings import Settings
from palpate.network.formula import Formula
from palpate.outcomes import Above, Below, Reading

__all__ = ["divided", "seen", "softened"]

Array = NDArray[np.float64]


def softened(vector: Array, error: float) -> Array:
    """An outcome vector, each of whose states gives a share of what it has evenly to the others (S,).

    Examples
    --------
    >>> softened(np.array([1.0, 0.0, 0.0]), 0.01).tolist()
    [0.99, 0.005, 0.005]
    """
    total = vector.sum()
    return np.asarray(((1 - error) * vector + error * (total - vector) / (len(vector) - 1)) / total)


def seen(grid: Grid, density: Array, outcome: Reading | Above | Below, sd: float) -> Array:
    """A density x what an outcome says (K,), not normalised; zero everywhere where it is impossible.

    A reading multiplies by a normal about it; a bound cuts at it and knows no noise.
    """
    if isinstance(outcome, Above):
        return np.asarray(density * (grid.nodes > outcome.bound))
    if isinstance(outcome, Below):
        return np.asarray(density * (grid.nodes < outcome.bound))
    log_factor = -0.5 * ((grid.nodes - outcome.value) / sd) ** 2
    # scaled to one where there is density: a reading far away must not vanish
    return np.asarray(density * np.exp(np.minimum(log_factor - log_factor[density > 0].max(), 0.0)))


def divided(
    graph: Graph, beliefs: Beliefs, derived: str, formula: Formula, reading: Reading, settings: Settings,
    rng: np.random.Generator,
) -> Array:  # fmt: skip
    """Samples of a quotient's target, from a reading of the derived property and the other nodes' beliefs.

    Parameters
    ----------
    derived, formula
        The derived property, and how it follows from continuous nodes.
    reading
        With its SD.

    Returns
    -------
    array
        At most `settings.quotient_samples` values (n,) [unit of the target]; those beyond the limit
        are dropped.
    """
    quotient, n = graph.quotients[derived], settings.quotient_samples
    values = rng.normal(reading.value, reading.sd or 0.0, n)
    others = {}
    for name in formula.variables:
        if name != quotient.target:
            grid = graph.mixtures[name].grid
            positive = beliefs[name] * (grid.nodes > 0)
            if not positive.any():
                return np.empty(0)
            others[name] = grid.draw(positive, n, rng)
    target = formula.solve(quotient.target, values, others)[0]
    return np.asarray(target[target <= quotient.limit])
