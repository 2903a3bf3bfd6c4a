"""The classifier of knocks that ships: fitted to the bench's own sounds, scored on modal tables that it has not met."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError
from palpate.estimators.classifier import Classifier, fit_classifier
from palpate.estimators.mel import mel_picture
from palpate.estimators.signals import SignalError
from palpate.estimators.sound import FEATURES, Impact, check_decay, features, impact
from palpate.outcomes import Failed
from palpate.robots.mujoco.hearing import RATE_HZ
from palpate.robots.mujoco.noise import BenchNoise
from palpate.robots.mujoco.training.held_out import (
    Examples,
    Probabilities,
    Scores,
    fit_temperature,
    held_out,
    scores,
    tempered,
)
from palpate.robots.mujoco.training.tables import Table

__all__ = ["FOLDS", "Trained", "answers", "draw_spectrograms", "record", "train"]

FOLDS = 5
DIGITS = 6


@dataclass(frozen=True, eq=False)
class Trained:
    """A classifier fitted to all examples, and scores of its like on tables that were held out."""

    classifier: Classifier
    scores: Scores


def record(tables: Sequence[Table], knocks: int, rng: np.random.Generator) -> Examples:
    """Features of so many knocks on each table; a table is a group. Knocks that cannot be told are left out.

    Raises
    ------
    PalpateError
        Not one knock of a table can be told.
    """
    return _heard(tables, knocks, rng, features)


def draw_spectrograms(tables: Sequence[Table], knocks: int, rng: np.random.Generator) -> Examples:
    """Pictures of the sounds of so many knocks on each table, as `record` has their features."""

    def picture(knock: Impact) -> NDArray[np.uint8]:
        check_decay(knock)
        return mel_picture(knock.samples, knock.rate_hz)

    return _heard(tables, knocks, rng, picture)


def _heard(
    tables: Sequence[Table], knocks: int, rng: np.random.Generator, told: Callable[[Impact], NDArray[np.generic]]
) -> Examples:
    noise = BenchNoise()
    rows: list[tuple[NDArray[np.generic], str, int]] = []
    for number, table in enumerate(tables):
        before = len(rows)
        for _ in range(knocks):
            try:
                rows.append((told(impact(table.sound(noise, rng), RATE_HZ)), table.label, number))
            except SignalError:
                continue
        if len(rows) == before:
            raise PalpateError(f"table {number}, {table.label}: not one of {knocks} knocks can be told from noise")
    inputs, labels, groups = zip(*rows, strict=True)
    return Examples(np.array(inputs), np.array(labels), np.array(groups))


def train(examples: Examples, rng: np.random.Generator, *, folds: int = FOLDS, source: str = "") -> Trained:
    """Fit to all examples; the temperature is that at which tables held out are told best.

    Scores are of tables that neither the fit nor its temperature has met.
    """
    states = examples.states
    probabilities = held_out(examples, folds, rng, lambda some, others: answers(_fit(some, folds, rng), others, states))
    whole = _fit(examples, folds, rng)
    # few digits, so that the same command writes the same file on machines that round a little differently
    tidy = replace(
        whole,
        means=_rounded(whole.means),
        precision=_rounded(whole.precision),
        temperature=round(whole.temperature, 3),
        source=source,
    )
    return Trained(tidy, scores(probabilities, examples.labels, states))


def answers(classifier: Classifier, examples: Examples, states: Sequence[str]) -> Probabilities:
    """Calibrated probabilities of states, (n, k): 0 for those it does not know, NaN where it fails."""
    found = np.full((len(examples.labels), len(states)), np.nan)
    for row, inputs in enumerate(examples.inputs):
        outcome = classifier.outcome(inputs)
        if not isinstance(outcome, Failed):
            found[row] = [outcome.probabilities.get(state, 0.0) for state in states]
    told = np.isfinite(found).all(axis=1)
    with np.errstate(divide="ignore"):
        found[told] = tempered(np.log(found[told]), classifier.temperature)
    return found


def _fit(examples: Examples, folds: int, rng: np.random.Generator) -> Classifier:
    """A classifier of all examples, and its temperature by examples held out in turn."""

    def plain(some: Examples) -> Classifier:
        return fit_classifier(some.inputs, some.labels.tolist(), FEATURES)

    states = examples.states
    probabilities = held_out(examples, folds, rng, lambda some, others: answers(plain(some), others, states))
    return replace(plain(examples), temperature=fit_temperature(probabilities, examples.labels, states))


def _rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    scale = 10.0 ** (DIGITS - 1 - np.floor(np.log10(np.maximum(np.abs(values), 1e-300))))
    return np.asarray(np.round(values * scale) / scale)
