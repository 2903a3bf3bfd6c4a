"""What stands in the tables about a point of an exploration."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence

from palpate.evidence import format_item
from palpate.experiments.branches import Branches, Taken
from palpate.experiments.measures import cross_entropy_bits
from palpate.experiments.reproduction.episodes import Goal, Point
from palpate.experiments.workers import Row
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.network.model import Network
from palpate.summary import CategoricalSummary, UnsaidSummary, summarise

__all__ = ["SHOWN", "Writer", "gain_columns"]

SHOWN = ("shown_states", "shown_x", "shown_values")
"""Columns that hold lists: the belief that is drawn, at the end of each run of a case study."""


class Writer:
    """Makes rows of points; what only depends on the belief is worked out once.

    Parameters
    ----------
    properties
        Those whose beliefs are described.
    """

    def __init__(self, branches: Branches, properties: Sequence[str]) -> None:
        self._branches, self._properties = branches, tuple(properties)
        self._beliefs: dict[int, dict[str, float | None]] = {}

    def row(self, goal: Goal, point: Point, realised: bool) -> Row:
        """The columns of a point: gains and entropies in bits, means and SDs in the property's unit.

        Parameters
        ----------
        realised
            Whether to work out the realised gain, which takes longer than all the rest.
        """
        belief = self._of_belief(point.taken)
        return {
            "step": len(point.taken),
            "stopped": point.stopped,
            "stop": point.stop,
            **self._of_last_action(goal, point.taken, realised),
            "entropy_bits": _total(belief[f"entropy_{name}_bits"] for name in goal.properties),
            **gain_columns(point.gains_bits, self._branches.network),
            **belief,
        }

    def shown(self, goal: Goal, point: Point) -> Row:
        """The belief about the goal's first property as a curve or as bars, in the columns `SHOWN`."""
        summary = summarise(self._branches.belief(point.taken))[goal.properties[0]]
        if isinstance(summary, UnsaidSummary):
            return {}
        if isinstance(summary, CategoricalSummary):
            names, values = list(summary.probabilities), list(summary.probabilities.values())
            return dict(zip(SHOWN, (names, None, values), strict=True))
        return dict(zip(SHOWN, (None, list(summary.x), list(summary.density)), strict=True))

    def _of_last_action(self, goal: Goal, taken: Taken, realised: bool) -> Row:
        """What was done, what it returned, and how far the belief moved; empty at the start."""
        names = ("action", "outcome", "expected_gain_bits", "realised_gain_bits", "entropy_drop_bits")
        if not taken:
            return dict.fromkeys(names)
        item = format_item(taken[-1], self._branches.outcome(taken))
        before, after = self._of_belief(taken[:-1]), self._of_belief(taken)
        drops = [_less(before[f"entropy_{name}_bits"], after[f"entropy_{name}_bits"]) for name in goal.properties]
        values = (
            taken[-1],
            json.dumps({key: value for key, value in item.items() if key != "action"}),
            self._branches.gains(taken[:-1], goal.properties)[taken[-1]],
            _total(self._branches.realised(taken, name) for name in goal.properties) if realised else None,
            _total(drops),
        )
        return dict(zip(names, values, strict=True))

    def _of_belief(self, taken: Taken) -> dict[str, float | None]:
        """Entropies, scores against the truth, means and SDs."""
        belief = self._branches.belief(taken)
        if id(belief) not in self._beliefs:
            found: dict[str, float | None] = {}
            for name in self._properties:
                found |= _figures(belief.marginal(name), self._branches.tape.truth.get(name))
            self._beliefs[id(belief)] = found
        return self._beliefs[id(belief)]


def gain_columns(gains_bits: Mapping[str, float], network: Network) -> Row:
    """A column for each action of the network, empty for those that are not left."""
    return {f"gain_{name}_bits": gains_bits.get(name) for name in network.actions}


def _figures(marginal: CategoricalMarginal | ContinuousMarginal, truth: str | float | None) -> dict[str, float | None]:
    """The columns of one property."""
    name, entropy_bits = marginal.name, marginal.entropy_bits
    if isinstance(marginal, CategoricalMarginal):
        known = truth in marginal.states
        score = cross_entropy_bits(marginal.probabilities, marginal.states.index(str(truth))) if known else None
        return {f"entropy_{name}_bits": entropy_bits, f"cross_entropy_{name}_bits": score}
    return {f"entropy_{name}_bits": entropy_bits, f"mean_{name}": marginal.mean, f"sd_{name}": marginal.sd}


def _total(values: Iterable[float | None]) -> float | None:
    """The sum; None where one of them is not known."""
    total = 0.0
    for value in values:
        if value is None:
            return None
        total += value
    return total


def _less(value: float | None, other: float | None) -> float | None:
    return None if value is None or other is None else value - other
