"""Draws from the belief against its marginals, which are worked out without draws."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy import stats

from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.network.reading import load_network
from palpate.outcomes import Above, Below, Label, Likelihood, Reading

N = 20_000
SEEN: dict[str, tuple[str, list[Any]]] = {
    "prior": ("household-filled", []),
    "weighed": ("household-filled", [("weighing", Reading(118.0))]),
    "light-mug": ("household-filled", [("cat-vision", Label("mug")), ("weighing", Reading(20.0))]),
    "sharp": ("household-filled", [("weighing", Reading(118.0, 0.05)), ("squeezing", Reading(40.0))]),
    "saturated": ("household-filled", [("squeezing", Above(95.0)), ("mat-sound", Label("metal"))]),
    "pantry": ("pantry", [("weigh", Reading(200.0)), ("ring", Below(20.0)), ("press", Reading(3.0))]),
    "pantry-ridge": ("pantry", [("weigh", Reading(300.0)), ("ring", Reading(100.0))]),
    "pantry-prior": ("pantry", []),
}


@cache
def belief(name: str) -> ExactBelief:
    network, seen = SEEN[name]
    made = ExactBelief(load_network(network))
    for action, outcome in seen:
        made = made.update(action, outcome)
    return made


@cache
def draws(name: str) -> Any:
    return belief(name).sample(N, np.random.default_rng(20))


@pytest.mark.parametrize("name", SEEN)
def test_draws_agree_with_the_marginals(name: str) -> None:
    """Frequencies, means and SDs of draws are those of the marginals within Monte Carlo error."""
    for prop, drawn in draws(name).items():
        assert len(drawn) == N
        marginal = belief(name).marginal(prop)
        if isinstance(marginal, CategoricalMarginal):
            p = marginal.probabilities
            counts = np.array([(drawn == state).mean() for state in marginal.states])
            assert (np.abs(counts - p) < 4.5 * np.sqrt(p * (1 - p) / N) + 1e-9).all(), prop
        else:
            assert isinstance(marginal, ContinuousMarginal)
            assert drawn.mean() == pytest.approx(marginal.mean, abs=4.5 * marginal.sd / np.sqrt(N)), prop
            spread = np.abs(drawn - drawn.mean()) ** 2
            assert spread.mean() == pytest.approx(marginal.sd**2, abs=5 * spread.std() / np.sqrt(N)), prop


@pytest.mark.parametrize("name", SEEN)
def test_draws_follow_the_distribution_functions(name: str) -> None:
    """The draws' distribution is the marginal's (Kolmogorov-Smirnov)."""
    network = belief(name).network
    for prop in [p.name for p in network.continuous] + [p.name for p in network.derived]:
        marginal = belief(name).marginal(prop)
        assert isinstance(marginal, ContinuousMarginal)
        drawn = draws(name)[prop][:4000]
        result = stats.kstest(drawn, np.vectorize(marginal.cdf))
        assert result.pvalue > 1e-4, (prop, result)


def test_derived_properties_follow_exactly() -> None:
    """Each draw's derived properties are their formulas of its other properties."""
    for name in ("prior", "weighed", "light-mug"):
        drawn = draws(name)
        assert drawn["mass"] == pytest.approx(drawn["density"] * drawn["volume"] / 1000, rel=1e-14)
    drawn = draws("pantry")
    assert drawn["contents"] == pytest.approx(drawn["capacity"] * drawn["fill"] / 100, rel=1e-14)
    assert drawn["headspace"] == pytest.approx(drawn["capacity"] - drawn["contents"], rel=1e-9, abs=1e-9)


def test_draws_are_joint() -> None:
    """After a sharp weighing each draw weighs that much, though density and volume spread widely."""
    drawn = draws("sharp")
    assert np.abs(drawn["mass"] - 118.0).max() < 0.5
    logs = np.log([drawn["density"], drawn["volume"]])
    assert logs.std(axis=1).min() > 0.1
    assert np.corrcoef(logs)[0, 1] < -0.999


def test_categorical_draws_are_joint() -> None:
    """Pairs of categorical states are as frequent as the joint table says."""
    drawn, network = draws("light-mug"), belief("light-mug").network
    table = belief("light-mug").probabilities("category", "material")
    counts = np.array(
        [
            [((drawn["category"] == c) & (drawn["material"] == m)).mean() for m in network.categorical[1].states]
            for c in network.categorical[0].states
        ]
    )
    assert (np.abs(counts - table) < 4.5 * np.sqrt(table * (1 - table) / N) + 1e-9).all()


def test_continuous_draws_are_those_of_their_states() -> None:
    """Among the draws of one category, numbers are those of the belief in which the category is known."""
    drawn, states = draws("weighed"), belief("weighed").network.categorical[0].states
    likely = states[int(belief("weighed").probabilities("category").argmax())]
    known = belief("weighed").update("cat-vision", Likelihood({s: float(s == likely) for s in states}))
    chosen = drawn["category"] == likely
    for name in ("elasticity", "density", "volume", "mass"):
        marginal = known.marginal(name)
        assert isinstance(marginal, ContinuousMarginal)
        error = marginal.sd / np.sqrt(chosen.sum())
        assert drawn[name][chosen].mean() == pytest.approx(marginal.mean, abs=4.5 * error), name


def test_draws_come_in_the_networks_order_and_by_the_seed() -> None:
    """All properties are drawn, in order, within their supports, and the same seed draws the same."""
    one = belief("weighed").sample(50, np.random.default_rng(3))
    same = belief("weighed").sample(50, np.random.default_rng(3))
    other = belief("weighed").sample(50, np.random.default_rng(4))
    assert list(one) == list(belief("weighed").network.properties)
    assert all((one[name] == same[name]).all() for name in one)
    assert (one["density"] != other["density"]).any()
    assert min(one[name].min() for name in ("elasticity", "density", "volume", "mass")) > 0


def test_no_draws_and_one_draw() -> None:
    """None and a single draw have the right shapes."""
    for n in (0, 1):
        assert {len(x) for x in belief("weighed").sample(n, np.random.default_rng(0)).values()} == {n}
