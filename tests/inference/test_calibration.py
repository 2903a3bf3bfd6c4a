"""Simulation-based calibration (Talts et al. 2018): truth and posterior draws are exchangeable.

Objects are drawn from the prior and measured by code of the tests' own; the rank of the truth
among draws from the belief must be uniform for every property.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.families import Normal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Above, Label, Outcome, Reading
from tests.oracle.brute_force import Oracle
from tests.oracle.networks import cube, singles, stack

Truth = dict[str, int | float]
DRAWS, BINS, SIMULATIONS = 63, 16, 160
REPERTOIRES = [
    ("cat-vision", "mat-sound"),
    ("squeezing", "weighing"),
    ("cat-vision", "weighing", "mat-vision", "weighing", "squeezing"),
]


@cache
def household() -> Network:
    return load_network("household")


def sample_object(network: Network, rng: np.random.Generator) -> Truth:
    """An object from the household's prior, state indices for categorical properties."""
    truth: Truth = {}
    for prop in network.properties.values():
        if isinstance(prop, CategoricalProperty):
            row = prop.table[tuple(int(truth[p]) for p in prop.parents)]
            truth[prop.name] = int(rng.choice(len(prop.states), p=row / row.sum()))
        elif isinstance(prop, ContinuousProperty):
            assert isinstance(prop.family, Normal)
            at = tuple(int(truth[p]) for p in prop.parents)
            value = -1.0
            while not prop.family.low[at] <= value <= prop.family.high[at]:
                value = float(rng.normal(prop.family.mean[at], prop.family.sd[at]))
            truth[prop.name] = value
    truth["mass"] = truth["density"] * truth["volume"] / 1000
    return truth


def measure(network: Network, action: str, truth: Truth, rng: np.random.Generator) -> Outcome:
    """An outcome of the action for the true properties."""
    sensor = network.actions[action].sensor
    if isinstance(sensor, ConfusionSensor):
        column = sensor.table[:, int(truth[sensor.property])]
        return Label(sensor.outcomes[int(rng.choice(len(column), p=column / column.sum()))])
    value = float(rng.normal(truth[sensor.property], sensor.sd))
    return Above(sensor.high) if value > sensor.high else Reading(value)


def rank(draws: NDArray[np.float64], truth: float, rng: np.random.Generator) -> int:
    """Rank of the truth among draws, ties (of categorical properties) broken by chance."""
    return int((draws < truth).sum() + rng.integers(0, (draws == truth).sum() + 1))


@pytest.mark.parametrize("actions", REPERTOIRES, ids="+".join)
def test_ranks_are_uniform(actions: tuple[str, ...]) -> None:
    """The rank of the truth among posterior draws is uniform for every property (chi-square)."""
    network, rng = household(), np.random.default_rng(2018)
    counts = {name: np.zeros(BINS) for name in network.properties}
    for _ in range(SIMULATIONS):
        truth, belief = sample_object(network, rng), ExactBelief(network)
        for action in actions:
            belief = belief.update(action, measure(network, action, truth, rng))
        drawn = belief.sample(DRAWS, rng)
        for name, prop in network.properties.items():
            if isinstance(prop, CategoricalProperty):
                index = {state: i for i, state in enumerate(prop.states)}
                draws = np.array([index[str(state)] for state in drawn[name]], float)
            else:
                draws = np.asarray(drawn[name], float)
            counts[name][rank(draws, float(truth[name]), rng) * BINS // (DRAWS + 1)] += 1
    for name, found in counts.items():
        assert stats.chisquare(found).pvalue > 1e-3, (name, found)


def test_distribution_functions_are_uniform() -> None:
    """The belief's distribution function at the truth is uniform for every continuous property."""
    network, rng = household(), np.random.default_rng(1960)
    names = [p.name for p in network.properties.values() if not isinstance(p, CategoricalProperty)]
    at_truth = np.empty((SIMULATIONS, len(names)))
    for row in at_truth:
        truth, belief = sample_object(network, rng), ExactBelief(network)
        for action in ("mat-vision", "weighing", "squeezing"):
            belief = belief.update(action, measure(network, action, truth, rng))
        marginals = [belief.marginal(name) for name in names]
        row[:] = [m.cdf(float(truth[m.name])) for m in marginals if isinstance(m, ContinuousMarginal)]
    for k, name in enumerate(names):
        assert stats.kstest(at_truth[:, k], "uniform").pvalue > 1e-3, name


@pytest.mark.parametrize("make", [cube, stack, singles])
def test_draws_follow_the_marginals(make: Callable[[], Oracle]) -> None:
    """Draws from a prior belief follow its own marginals, in small networks of every family."""
    network = make().network
    belief = ExactBelief(network)
    drawn = belief.sample(1500, np.random.default_rng(3))
    for name in network.properties:
        marginal = belief.marginal(name)
        if isinstance(marginal, ContinuousMarginal):
            below = [marginal.cdf(float(x)) for x in drawn[name]]
            assert stats.kstest(below, "uniform").pvalue > 1e-3, name
        else:
            seen = np.array([(drawn[name] == state).sum() for state in marginal.states])
            assert stats.chisquare(seen, marginal.probabilities * seen.sum()).pvalue > 1e-3, name
