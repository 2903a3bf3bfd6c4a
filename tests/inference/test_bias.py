"""A sensor with a bias is one without, whose readings and limits are lower by as much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import palpate
from palpate.inference.exact import ExactBelief
from palpate.inference.message_passing.belief import MessagePassingBelief
from palpate.inference.predictions import NumberPrediction
from palpate.network.digest import digest
from palpate.network.model import Network
from palpate.network.sensors import NumberSensor
from palpate.outcomes import Above, Below, Label, Outcome, Reading
from tests.oracle.networks import cube, singles, stack

BIAS = 2.5
Seen = tuple[str, Outcome]


def shifted(network: Network, bias: float, limits: float) -> Network:
    """The network with other biases and limits of its sensors of numbers."""
    for action in network.actions.values():
        s = action.sensor
        if isinstance(s, NumberSensor):
            sensor = replace(s, bias=bias, low=s.low + limits, high=s.high + limits)
            network = network.with_action(replace(action, sensor=sensor))
    return network


def higher(outcome: Outcome) -> Outcome:
    """The outcome as a sensor with the bias gives it."""
    if isinstance(outcome, Reading):
        return replace(outcome, value=outcome.value + BIAS)
    return replace(outcome, bound=outcome.bound + BIAS) if isinstance(outcome, Above | Below) else outcome


HOUSEHOLD = "a08fa2a3abfe2c97"
"""The digest of the network household, as logs have it."""

CASES: dict[str, tuple[Network, Sequence[Seen]]] = {
    "household": (
        palpate.load_network("household"),
        [("squeezing", Above(95.0)), ("weighing", Reading(118.0)), ("cat-vision", Label("mug"))],
    ),
    "household, soft": (
        palpate.load_network("household"),
        [("squeezing", Reading(3.0)), ("squeezing", Reading(9.0, 2.0)), ("weighing", Reading(11.0))],
    ),
    "heavy tails, an offset": (
        stack().network,
        [("rod", Reading(15.0)), ("laser", Reading(14.5)), ("rod", Reading(14.8)), ("gauge", Below(5.0))],
    ),
    "relative, heavy with an offset": (
        singles().network,
        [("float", Reading(33.0)), ("probe", Reading(1.0)), ("probe", Reading(1.6)), ("feeler", Above(5.0))],
    ),
    "a power": (cube().network, [("dunk", Reading(30.0)), ("touch", Below(3.0)), ("ruler", Reading(3.0))]),
}


@pytest.mark.parametrize("name", CASES)
def test_a_bias_is_a_shift_of_readings_and_limits(name: str) -> None:
    """Beliefs, evidence, gains, predictions and surprise are those without it."""
    network, seen = CASES[name]
    plain, biased = ExactBelief(network), ExactBelief(shifted(network, BIAS, BIAS))
    _same(plain, biased)
    for action, outcome in seen:
        assert biased.surprise(action, higher(outcome)) == pytest.approx(plain.surprise(action, outcome), abs=1e-6)
        before = plain, biased
        plain, biased = plain.update(action, outcome), biased.update(action, higher(outcome))
        assert biased.log_evidence_bits == pytest.approx(plain.log_evidence_bits, abs=1e-6)
        gains = [one.realised_gain(after, "everything") for one, after in zip(before, (plain, biased), strict=True)]
        assert gains[1] == pytest.approx(gains[0], abs=1e-6)
        _same(plain, biased)


def _same(plain: ExactBelief, biased: ExactBelief) -> None:
    for prop in plain.network.categorical:
        assert biased.probabilities(prop.name) == pytest.approx(plain.probabilities(prop.name), abs=1e-7)
    objectives = ["everything", *plain.network.properties]
    gains, others = plain.expected_gains(objectives), biased.expected_gains(objectives)
    for action, row in gains.items():
        assert others[action] == pytest.approx(row, abs=2e-6)
        first, second = plain.predict(action), biased.predict(action)
        if isinstance(first, NumberPrediction):
            assert isinstance(second, NumberPrediction)
            y = np.linspace(0.0, 90.0, 7)
            assert second.cdf(y + BIAS) == pytest.approx(first.cdf(y), abs=1e-9)
            assert (second.above, second.below) == pytest.approx((first.above, first.below), abs=1e-9)


def test_a_batch_of_beliefs_uses_the_bias() -> None:
    """Explorations in step come to the beliefs that the same outcomes give one after the other."""
    network = shifted(palpate.load_network("household-filled"), -6.0, 0.0)
    robots = [palpate.SampledRobot(network, "ceramic_mug", np.random.default_rng(seed)) for seed in range(8)]
    order = palpate.FixedOrder(["weighing", "squeezing"])
    for run in palpate.explore_many(ExactBelief(network), robots, policy=order, rng=np.random.default_rng(0)):
        belief = ExactBelief(network)
        for action, outcome in zip(run.actions, run.outcomes, strict=True):
            belief = belief.update(action, outcome)
        assert run.actions
        assert run.beliefs[-1].probabilities("material") == pytest.approx(belief.probabilities("material"), abs=1e-9)


def test_drawn_readings_have_the_bias() -> None:
    """Their mean is above the true value by as much."""
    network = shifted(palpate.load_network("household-filled"), 4.0, 0.0)
    robot = palpate.SampledRobot(network, "banana_ycb", np.random.default_rng(1))
    readings = [robot.perform("weighing") for _ in range(500)]
    values = [one.value for one in readings if isinstance(one, Reading)]
    assert np.mean(values) == pytest.approx(66.0 + 4.0, abs=4 * 6 / np.sqrt(500))


@pytest.mark.parametrize("outcome", [Reading(40.0), Above(95.0)])
def test_message_passing_takes_the_bias_off(outcome: Outcome) -> None:
    """Its beliefs are those without bias after a reading that is lower by as much."""
    network = palpate.load_network("household")
    plain = MessagePassingBelief(network).update("squeezing", outcome)
    biased = MessagePassingBelief(shifted(network, BIAS, BIAS)).update("squeezing", higher(outcome))
    assert biased.probabilities("material") == pytest.approx(plain.probabilities("material"), abs=1e-9)
    weighed, too = plain.update("weighing", Reading(66.0)), biased.update("weighing", Reading(66.0 + BIAS))
    assert too.probabilities("category") == pytest.approx(weighed.probabilities("category"), abs=1e-9)


def test_a_network_without_bias_keeps_its_digest() -> None:
    """Logs that were made before sensors had one still fit; with one it is another model."""
    network = palpate.load_network("household")
    assert digest(network) == HOUSEHOLD
    assert digest(shifted(network, 1.0, 0.0)) != HOUSEHOLD
