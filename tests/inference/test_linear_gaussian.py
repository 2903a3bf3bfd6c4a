"""Sums of normal properties with sensors of very different noise, against closed forms of linear algebra."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from palpate.inference.batch import updated
from palpate.inference.belief import Observation
from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.formula import Formula
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property
from palpate.network.sensors import NumberSensor, Sensor
from palpate.outcomes import Reading
from tests.oracle.networks import network, normal

Array = NDArray[np.float64]
MEANS, SD, PRIOR = (100.0, 112.0), 5.0, np.array([0.4, 0.6])
SEEN = {"x": np.array([1.0, 0.0]), "z": np.array([1.0, 1.0])}


def kinds() -> CategoricalProperty:
    return CategoricalProperty("kind", ("a", "b"), (), PRIOR)


def summed(sensors: Mapping[str, Sensor], spread: float) -> Network:
    """z = x + y, x normal given its kind, y normal about 50."""
    properties: list[Property] = [
        kinds(),
        ContinuousProperty("x", "g", ("kind",), normal(MEANS, [SD, SD])),
        ContinuousProperty("y", "g", (), normal(50.0, spread)),
        DerivedProperty("z", "g", Formula.parse("x + y")),
    ]
    return network("summed", properties, sensors)


@dataclass
class Linear:
    """State (x, y, offset of the sensor) given each kind: normal, updated by linear readings (Kalman)."""

    spread: float
    offset_sd: float = 0.0

    def __post_init__(self) -> None:
        own = np.diag([SD**2, self.spread**2, self.offset_sd**2])
        self.given = [(np.array([mean, 50.0, 0.0]), own) for mean in MEANS]
        self.log_weight = np.log(PRIOR)

    def read(self, name: str, value: float, sd: float) -> None:
        h = np.append(SEEN[name], float(self.offset_sd > 0))
        for k, (mean, cov) in enumerate(self.given):
            variance = h @ cov @ h + sd**2
            self.log_weight[k] += -0.5 * (value - h @ mean) ** 2 / variance - 0.5 * np.log(variance)
            gain = cov @ h / variance
            self.given[k] = mean + gain * (value - h @ mean), cov - np.outer(gain, h @ cov)

    def gains(self, name: str, sd: float) -> tuple[float, float]:
        """I(kind; next reading) and I(what is read; next reading) [bits]."""
        h, direct = np.append(SEEN[name], float(self.offset_sd > 0)), np.append(SEEN[name], 0.0)
        weight = np.exp(self.log_weight - self.log_weight.max())
        weight /= weight.sum()
        means = [h @ m for m, _ in self.given]
        variances = [h @ c @ h + sd**2 for _, c in self.given]
        far = 9 * np.sqrt(max(variances))
        y, step = np.linspace(min(means) - far, max(means) + far, 200_001, retstep=True)
        parts = [
            np.exp(-0.5 * (y - m) ** 2 / v) / np.sqrt(2 * np.pi * v) for m, v in zip(means, variances, strict=True)
        ]
        whole = entropy_bits(weight @ np.array(parts), step)
        cov = self.given[0][1]
        left = h @ cov @ h + sd**2 - (h @ cov @ direct) ** 2 / (direct @ cov @ direct)
        of_kind = whole - sum(w * entropy_bits(p, step) for w, p in zip(weight, parts, strict=True))
        return of_kind, whole - 0.5 * np.log2(2 * np.pi * math.e * left)


def entropy_bits(density: Array, step: float) -> float:
    held = density[density > 0]
    return float(-(held * np.log2(held)).sum() * step)


@pytest.mark.parametrize("spread", [8.0, 4.0, 2.0, 1.0, 0.5])
@pytest.mark.parametrize(("of_sum", "of_part"), [(0.2, 0.2), (1.0, 0.2), (0.2, 1.0)])
def test_a_sharp_sensor_after_a_reading_of_a_sum(spread: float, of_sum: float, of_part: float) -> None:
    """A density that a reading of the sum has narrowed is resolved for a sensor that is sharper still."""
    net = summed({"weigh": NumberSensor("z", of_sum), "gauge": NumberSensor("x", of_part)}, spread)
    gains = ExactBelief(net).update("weigh", Reading(157.0)).expected_gains(["kind", "x"], ["gauge"])["gauge"]
    oracle = Linear(spread)
    oracle.read("z", 157.0, of_sum)
    assert (gains["kind"], gains["x"]) == pytest.approx(oracle.gains("x", of_part), abs=2e-4)


@pytest.mark.parametrize(
    ("sd", "offset_sd", "values"),
    [
        (1.0, 50.0, [130.0]),
        (0.1, 50.0, [130.0]),
        (6.0, 60.0, [120.0]),
        (1.0, 10.0, [150.0, 151.0]),
        (1.0, 5.0, [104.0]),
        (2.0, 6.0, [104.0]),
        (1.0, 500.0, [130.0]),
        (1.0, 50.0, [500.0]),
    ],
)
def test_the_next_reading_of_a_sensor_with_an_offset(sd: float, offset_sd: float, values: Sequence[float]) -> None:
    """Where readings share a wide offset, one that follows others lies near them, and tells little more."""
    net = summed({"gauge": NumberSensor("x", sd, offset_sd=offset_sd)}, 3.0)
    belief, oracle = ExactBelief(net), Linear(3.0, offset_sd)
    for value in values:
        belief = belief.update("gauge", Reading(value))
        oracle.read("x", value, sd)
    gains = belief.expected_gains(["kind", "x"], ["gauge"])["gauge"]
    assert (gains["kind"], gains["x"]) == pytest.approx(oracle.gains("x", sd), abs=1e-5)


def test_actions_that_share_a_sensor_object() -> None:
    """What an action will return depends on its own readings, whoever made its sensor."""
    sensor = NumberSensor("x", 2.0, offset_sd=4.0)
    gains = []
    for second in (sensor, NumberSensor("x", 2.0, offset_sd=4.0)):
        belief = ExactBelief(summed({"first": sensor, "second": second}, 3.0))
        for action, value in (("first", 104.0), ("first", 103.0), ("second", 110.0)):
            belief = belief.update(action, Reading(value))
        gains.append(belief.expected_gains(["kind"])["second"]["kind"])
    assert gains[0] == pytest.approx(gains[1], abs=1e-12)


def test_a_derived_property_without_parents() -> None:
    """Sides all alike: the cube of one is read, updated and drawn like any property."""
    side = ContinuousProperty("side", "cm", (), normal(3.0, 0.5, 0.0))
    bulk = DerivedProperty("bulk", "cm**3", Formula.parse("side ** 3"))
    belief = ExactBelief(network("cubes", [side, bulk], {"dunk": NumberSensor("bulk", 2.0)}))
    assert belief.expected_gains(["side"])["dunk"]["side"] == belief.expected_gains()["dunk"]["bulk"]
    after = belief.update("dunk", Reading(30.0))
    (together,) = updated([belief], [Observation("dunk", Reading(30.0))])
    assert together.log_evidence_bits == pytest.approx(after.log_evidence_bits, abs=1e-9)
    drawn = after.sample(2000, np.random.default_rng(1))
    assert np.asarray(drawn["side"], float) ** 3 == pytest.approx(np.asarray(drawn["bulk"], float))
    marginal = after.marginal("bulk")
    assert isinstance(marginal, ContinuousMarginal)
    assert np.asarray(drawn["bulk"], float).mean() == pytest.approx(marginal.mean, abs=4 * marginal.sd / 2000**0.5)


def test_beliefs_together_are_those_alone_in_unlikely_configurations() -> None:
    """A label that rules out the likely states leaves what single updates leave, however faint it was."""
    shapes = CategoricalProperty("kind", ("a", "b", "c"), (), np.array([0.4, 0.3, 0.3]))
    x = ContinuousProperty("x", "g", ("kind",), normal([100.0, 180.0, 193.3], [5.0, 2.5, 3.0]))
    net = network("far", [shapes, x], {"weigh": NumberSensor("x", 0.7)})
    belief = ExactBelief(net)
    alone = belief.update("weigh", Reading(102.0))
    (together,) = updated([belief], [Observation("weigh", Reading(102.0))])
    assert np.asarray(together.log_joint) == pytest.approx(np.asarray(alone.log_joint), abs=1e-9)
