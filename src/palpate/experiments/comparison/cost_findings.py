"""What a comparison found on paths: how soon targets are reached, what stopping does, how far from the optimum."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.experiments.comparison.results import Path, Results
from palpate.experiments.statistics import bootstrap_interval

__all__ = ["Reached", "Stopped", "over_time", "reached", "regret", "stopped"]

Array = NDArray[np.float64]
TARGET_BITS = 0.5


@dataclass(frozen=True)
class Reached:
    """How soon a target is reached, means over objects.

    Parameters
    ----------
    share
        Of the objects, with which the target is reached at all.
    actions, cost_s
        Until then; all there are where it is never reached.
    """

    share: float
    actions: float
    cost_s: float


@dataclass(frozen=True)
class Stopped:
    """What a stopping rule does, means over objects.

    Parameters
    ----------
    actions, cost_s, cross_entropy_bits
        When it stopped.
    right
        Share of the objects with which the most probable states were right when it stopped.
    premature
        Share of the objects with which it stopped before they were right, though further actions of the
        same method would have made them right for good.
    wasted
        Actions after they were right for good.
    """

    actions: float
    cost_s: float
    cross_entropy_bits: float
    right: float
    premature: float
    wasted: float


def reached(own: Results, target_bits: float = TARGET_BITS) -> Reached:
    """How soon the cross-entropy of the truth, mean of the categorical properties, is at most the target.

    Parameters
    ----------
    own
        The rows of one method in one world.
    """
    bits, cost_s = own.over_states("cross_entropy_bits"), own.numbers("cost_s")
    paths = list(own.paths())
    first = [_first(bits[path.rows] <= target_bits) for path in paths]
    steps = [len(path.rows) - 1 if step is None else step for path, step in zip(paths, first, strict=True)]
    return Reached(
        _mean(paths, [float(step is not None) for step in first]),
        _mean(paths, steps),
        _mean(paths, [float(cost_s[path.rows[step]]) for path, step in zip(paths, steps, strict=True)]),
    )


def stopped(own: Results, column: str, threshold: float) -> Stopped:
    """What happens when a method stops as soon as a column is at most a threshold.

    Parameters
    ----------
    column
        ``best_gain_bits``, or ``worth_bits_per_s``, the largest gain per cost: stopping when that is at
        most lambda is stopping when no gain less lambda x cost is above zero.
    """
    left, cost_s = own.numbers(column), own.numbers("cost_s")
    bits, right = own.over_states("cross_entropy_bits"), own.over_states("correct") == 1
    paths = list(own.paths())
    ends = [_stop(left[path.rows], threshold) for path in paths]
    enough = [_for_good(right[path.rows]) for path in paths]
    at_end = [path.rows[end] for path, end in zip(paths, ends, strict=True)]
    pairs = list(zip(ends, enough, strict=True))
    return Stopped(
        _mean(paths, ends),
        _mean(paths, cost_s[at_end]),
        _mean(paths, bits[at_end]),
        _mean(paths, right[at_end].astype(float)),
        _mean(paths, [float(good is not None and end < good) for end, good in pairs]),
        _mean(paths, [0.0 if good is None else float(max(0, end - good)) for end, good in pairs]),
    )


def over_time(own: Results) -> dict[str, float]:
    """By object: the mean of the cross-entropy over the time that all actions take [bits].

    What was believed before an action counts for as long as the action takes.
    """
    bits, cost_s = own.over_states("cross_entropy_bits"), own.numbers("cost_s")
    totals: dict[str, float] = {}
    weights: dict[str, float] = {}
    for path in own.paths():
        times = np.diff(cost_s[path.rows])
        score = float(bits[path.rows[:-1]] @ times / times.sum())
        totals[path.object] = totals.get(path.object, 0.0) + path.weight * score
        weights[path.object] = weights.get(path.object, 0.0) + path.weight
    return {name: total / weights[name] for name, total in totals.items()}


def regret(own: Results, optimum: Results) -> list[tuple[float, float, float]]:
    """Information that the optimal adaptive policy gives more than a method [bits], by number of actions.

    The method's is the mean of the sums of expected gains on its paths, which is the information it
    gives where objects and outcomes are drawn from the network that is believed.

    Returns
    -------
    list of tuple
        The regret and the ends of its 95 % interval over objects: of a few objects it can be below zero.
    """
    found = []
    for step, bits in _informed(optimum):
        part = own.where(step=step)
        lost = bits - np.array(list(part.by_object(part.numbers("information_bits")).values()))
        found.append((float(lost.mean()), *bootstrap_interval(lost)))
    return found


def _informed(optimum: Results) -> Iterable[tuple[float, float]]:
    rows = optimum.where(method="optimal")
    return zip(rows.numbers("step").tolist(), rows.numbers("information_bits").tolist(), strict=True)


def _first(holds: NDArray[np.bool_]) -> int | None:
    """The first place where it holds."""
    return int(holds.argmax()) if holds.any() else None


def _stop(left: Array, threshold: float) -> int:
    """The first place where what is left is at most the threshold; the last where it never is."""
    found = _first(~(left > threshold))  # where nothing is left there is no number
    return len(left) - 1 if found is None else found


def _for_good(right: NDArray[np.bool_]) -> int | None:
    """The first place from which all that follow are right; None where the last one is wrong."""
    wrong = np.flatnonzero(~right)
    if not len(wrong):
        return 0
    return None if wrong[-1] == len(right) - 1 else int(wrong[-1]) + 1


def _mean(paths: list[Path], values: Iterable[float]) -> float:
    """Mean over objects of the weighted mean over an object's paths."""
    sums: dict[str, list[float]] = {}
    for path, value in zip(paths, values, strict=True):
        own = sums.setdefault(path.object, [0.0, 0.0])
        own[0] += path.weight * value
        own[1] += path.weight
    return float(np.mean([total / weight for total, weight in sums.values()]))
