"""The most that any method can learn with so many actions, by enumeration of all outcomes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from palpate.experiments.comparison.contest import objective_of
from palpate.experiments.comparison.worlds import World
from palpate.experiments.running import Row
from palpate.inference.exact import ExactBelief
from palpate.selection.tabled import Tabled

__all__ = ["Myopic", "OptimumTask"]


class Myopic(Tabled):
    """Plans that choose, after each outcome, the action with the largest gain at once."""

    def _value(self, taken: tuple[str, ...], depth: int) -> NDArray[np.float64]:
        names, weights = self._left(taken), self._outcomes(taken)
        first = np.argmax([self._gain(weights, name) for name in names], axis=0)
        told = np.stack([self._after(taken, name, depth) for name in names])
        return np.asarray(np.take_along_axis(told, first[None], axis=0)[0])


@dataclass(frozen=True)
class OptimumTask:
    """Expected information of adaptive policies and of fixed sets, by enumeration of all outcomes.

    Parameters
    ----------
    depth
        Actions up to which it is worked out; the time grows by a factor of some 15 with each.
    """

    world: World
    depth: int

    @property
    def key(self) -> str:
        """A name of its own."""
        return f"optimum-{self.world.name}"

    def run(self) -> list[Row]:
        """Information [bits] by number of actions: of the optimal policy, greedy, and sets fixed beforehand."""
        network, actions = self.world.believed, tuple(self.world.believed.actions)
        belief, objective = ExactBelief(network), objective_of(network)
        best, myopic = Tabled(belief, objective, actions), Myopic(belief, objective, actions)
        gains = objective.gains(belief, actions)
        first = max(actions, key=gains.__getitem__)
        found: dict[tuple[str, int], float] = {}
        for size in range(1, self.depth + 1):
            told = [best.together(chosen) for chosen in combinations(actions, size)]
            found["optimal", size] = max(best.best(action, size) for action in actions)
            found["greedy", size] = myopic.best(first, size)
            found["best set", size], found["any set", size] = max(told), float(np.mean(told))
        return [
            {"world": self.world.name, "method": method, "step": step, "weight": 1.0, "information_bits": bits}
            for (method, step), bits in found.items()
        ]
