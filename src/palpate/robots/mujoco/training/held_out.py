"""How good a classifier is on groups that it has not met, and how sure it may be."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.network.vectors import FLOOR

__all__ = ["Examples", "Scores", "fit_temperature", "folds", "held_out", "scores", "tempered"]

COLDEST, HOTTEST = 0.25, 20.0


@dataclass(frozen=True, eq=False)
class Examples:
    """Inputs with their labels, and the group that each belongs to.

    Attributes
    ----------
    inputs
        (n, ...).
    labels
        Names, (n).
    groups
        Numbers, (n): examples of one group are copies of each other, but for noise.
    """

    inputs: NDArray[np.generic]
    labels: NDArray[np.str_]
    groups: NDArray[np.int64]

    def of(self, chosen: NDArray[np.bool_]) -> Examples:
        """Those that were chosen, by a mask (n)."""
        return Examples(self.inputs[chosen], self.labels[chosen], self.groups[chosen])

    @property
    def states(self) -> tuple[str, ...]:
        """The labels that occur, sorted."""
        return tuple(sorted(set(self.labels.tolist())))


Probabilities = NDArray[np.float64]
"""Of the states by example, (n, k); NaN where an example gave none."""


@dataclass(frozen=True, eq=False)
class Scores:
    """How good probabilities are.

    Attributes
    ----------
    states
        Names, k.
    confusion
        Share of what was told, by truth: (k, k), rows are the truth and sum to one but for what failed; NaN where no
        example is of a state.
    balanced_accuracy
        Mean of its diagonal.
    gain_bits
        Mean over the states of what the truth was worth: log2 of its probability over that of a uniform prior. Not
        above zero is no better than saying nothing.
    failed
        Share of examples without an answer; they are worth nothing, and belong to no column.
    """

    states: tuple[str, ...]
    confusion: NDArray[np.float64]
    balanced_accuracy: float
    gain_bits: float
    failed: float


def folds(examples: Examples, count: int, rng: np.random.Generator) -> Iterator[NDArray[np.bool_]]:
    """Masks, (n), of what is held out: whole groups, each once, and of each label about as many in each fold.

    Examples
    --------
    >>> found = Examples(np.zeros(6), np.array(list("aaaabb")), np.array([0, 0, 1, 1, 2, 3]))
    >>> sorted(int(mask.sum()) for mask in folds(found, 2, np.random.default_rng(1)))
    [3, 3]
    """
    place = {}
    for state in examples.states:
        groups = rng.permutation(np.unique(examples.groups[examples.labels == state]))
        place.update({int(group): number % count for number, group in enumerate(groups)})
    folded = np.array([place[int(group)] for group in examples.groups])
    for number in range(count):
        yield folded == number


def held_out(
    examples: Examples,
    count: int,
    rng: np.random.Generator,
    answer: Callable[[Examples, Examples], Probabilities],
) -> Probabilities:
    """Probabilities of each example by what was learned without its group.

    Parameters
    ----------
    count
        Of folds.
    answer
        Learns from some examples, and gives probabilities of `examples.states` for others.
    """
    found = np.full((len(examples.labels), len(examples.states)), np.nan)
    for mask in folds(examples, count, rng):
        found[mask] = answer(examples.of(~mask), examples.of(mask))
    return found


def scores(probabilities: Probabilities, labels: NDArray[np.str_], states: Sequence[str]) -> Scores:
    """Score probabilities of states, (n, k), against the truth.

    Examples
    --------
    >>> found = scores(np.array([[0.9, 0.1], [0.5, 0.5]]), np.array(["dull", "ringing"]), ["dull", "ringing"])
    >>> found.balanced_accuracy, round(found.gain_bits, 3)
    (0.5, 0.424)
    """
    told = np.asarray(np.isfinite(probabilities).all(axis=1))
    truth = np.array([list(states).index(label) for label in labels.tolist()])
    confusion, worth = np.full((len(states), len(states)), np.nan), np.full(len(states), np.nan)
    best = np.where(told, np.argmax(np.where(told[:, None], probabilities, 0.0), axis=1), -1)
    gains = np.where(told, _bits(probabilities, truth), 0.0)
    for state in np.unique(truth):
        mine = np.equal(truth, state)
        confusion[state] = [np.mean(best[mine] == other) for other in range(len(states))]
        worth[state] = gains[mine].mean()
    return Scores(
        tuple(states),
        confusion,
        float(np.nanmean(np.diag(confusion))),
        float(np.nanmean(worth)),
        float(1 - told.mean()),
    )


def fit_temperature(probabilities: Probabilities, labels: NDArray[np.str_], states: Sequence[str]) -> float:
    """Temperature at which the truth is worth most: above one where probabilities, (n, k), are surer than right.

    Examples
    --------
    >>> sure = np.array([[0.99, 0.01]] * 4 + [[0.01, 0.99]] * 4)
    >>> round(fit_temperature(sure, np.array(list("aaabbbba")), ["a", "b"]), 1)
    4.2
    """
    from scipy.optimize import minimize_scalar

    told = np.asarray(np.isfinite(probabilities).all(axis=1))
    truth = np.array([list(states).index(label) for label in labels.tolist()])[told]
    weights = 1 / np.bincount(truth, minlength=len(states))[truth]
    logs = np.log(np.maximum(probabilities[told], 1e-300))

    def loss(log_temperature: float) -> float:
        return -float(weights @ _bits(tempered(logs, np.exp(log_temperature)), truth))

    found = minimize_scalar(loss, bounds=np.log([COLDEST, HOTTEST]), method="bounded")
    return float(np.exp(found.x))


def tempered(logs: NDArray[np.float64], temperature: float) -> Probabilities:
    """Probabilities from their logarithms, (n, k), at a temperature."""
    scaled = logs / temperature
    raised = np.exp(scaled - scaled.max(axis=1, keepdims=True))
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))


def _bits(probabilities: Probabilities, truth: NDArray[np.int64]) -> NDArray[np.float64]:
    """What the truth is worth over a uniform prior, (n), with probabilities floored as beliefs do it."""
    floored = np.maximum(probabilities / probabilities.max(axis=1, keepdims=True), FLOOR)
    floored = floored / floored.sum(axis=1, keepdims=True)
    return np.asarray(np.log2(floored[np.arange(len(truth)), truth] * probabilities.shape[1]))
