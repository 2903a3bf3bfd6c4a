from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from palpate.errors import EvidenceError
from palpate.network.families import LogNormal
from palpate.network.formula import Formula
from palpate.network.model import Action, KnownObject, Network, TrueValue
from palpate.network.noises import StudentTNoise
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Below, Label, Reading
from palpate.robots.contract import RobotContract
from palpate.robots.sampled import SampledRobot

TABLE = np.array([[0.7, 0.2, 0.1], [0.1, 0.5, 0.3], [0.2, 0.3, 0.6]])


def known(name: str, stuff: str, side: float, looks_like: str | None = None) -> Any:
    truth = {"stuff": TrueValue(stuff, "assumed"), "side": TrueValue(side, "assumed")}
    return KnownObject(name, "", truth, looks_like)


@pytest.fixture
def network() -> Any:
    stuff = CategoricalProperty("stuff", ("oak", "clay", "wool"), (), np.full(3, 1 / 3))
    side = ContinuousProperty("side", "cm", (), LogNormal(np.array(5.0), np.array(0.5)))
    bulk = DerivedProperty("bulk", "cm^3", Formula.parse("side ** 3"))
    look = ConfusionSensor("stuff", ("a", "b", "c"), TABLE)
    actions = [
        Action("look", 1.0, look, sees_appearance=True),
        Action("knock", 1.0, look),
        Action("measure", 2.0, NumberSensor("side", 0.1, relative_sd=0.05, low=4.0, high=6.0)),
        Action("dip", 3.0, NumberSensor("bulk", 2.0, noise=StudentTNoise(4.0))),
    ]
    things = [known("cube", "oak", 5.0), known("fake", "wool", 5.0, looks_like="cube")]
    return Network(
        "toy",
        {p.name: p for p in (stuff, side, bulk)},
        {a.name: a for a in actions},
        {thing.name: thing for thing in things},
    )


def with_sensor(network: Network, name: str, **changed: Any) -> Any:
    action = network.action(name)
    return network.with_action(replace(action, sensor=replace(action.sensor, **changed)))


def draw(robot: Any, action: str, n: int) -> Any:
    return [robot.perform(action) for _ in range(n)]


class TestSampledHousehold(RobotContract):
    """The shipped network's objects make robots that keep the contract."""

    network = load_network("household")

    def make_robot(self) -> Any:
        return SampledRobot(self.network, "banana_ycb", np.random.default_rng(1))


def test_labels_follow_the_column_of_the_true_state(network: Network) -> None:
    """Labels of repeated looks are drawn with the frequencies of the true state's column."""
    robot = SampledRobot(network, "fake", np.random.default_rng(0))
    labels = [outcome.label for outcome in draw(robot, "knock", 3000)]
    counts = [labels.count(name) for name in ("a", "b", "c")]
    assert stats.chisquare(counts, TABLE[:, 2] * 3000).pvalue > 1e-3


def test_the_camera_sees_what_an_object_looks_like(network: Network) -> None:
    """An action that sees the appearance is drawn for the object that a trick looks like."""
    robot = SampledRobot(network, "fake", np.random.default_rng(0))
    labels = [outcome.label for outcome in draw(robot, "look", 3000)]
    counts = [labels.count(name) for name in ("a", "b", "c")]
    assert stats.chisquare(counts, TABLE[:, 0] * 3000).pvalue > 1e-3


def test_readings_follow_the_noise_and_saturate(network: Network) -> None:
    """Readings within the range are normal about the truth; those beyond become bounds as often as due."""
    robot = SampledRobot(network, {"side": 5.9}, np.random.default_rng(0))
    outcomes = draw(robot, "measure", 4000)
    sd = np.hypot(0.1, 0.05 * 5.9)
    above = sum(outcome == Above(6.0) for outcome in outcomes)
    assert stats.binomtest(above, 4000, stats.norm.sf(6.0, 5.9, sd)).pvalue > 1e-3
    inside = [outcome.value for outcome in outcomes if isinstance(outcome, Reading)]
    cut = stats.truncnorm((4.0 - 5.9) / sd, (6.0 - 5.9) / sd, 5.9, sd)
    assert stats.kstest(inside, cut.cdf).pvalue > 1e-3
    low = SampledRobot(network, {"side": 1.0}, np.random.default_rng(0))
    assert low.perform("measure") == Below(4.0)


def test_a_derived_property_follows_from_the_others(network: Network) -> None:
    """The truth of a derived property is computed, and its sensor has its own form of noise."""
    robot = SampledRobot(network, "cube", np.random.default_rng(0))
    values = np.array([outcome.value for outcome in draw(robot, "dip", 2000)])
    assert stats.kstest((values - 125.0) / 2.0, stats.t(4.0).cdf).pvalue > 1e-3


def test_a_truth_that_is_given_wins_over_the_formula(network: Network) -> None:
    """A derived property whose truth is given is not computed."""
    sharp = with_sensor(network, "dip", sd=1e-9)
    robot = SampledRobot(sharp, {"side": 5.0, "bulk": 90.0}, np.random.default_rng(0))
    (outcome,) = draw(robot, "dip", 1)
    assert outcome.value == pytest.approx(90.0, abs=1e-6)


def test_an_offset_is_shared_by_all_readings_of_an_object(network: Network) -> None:
    """Readings of one object scatter about a common offset, which differs between objects."""
    shared = with_sensor(network, "dip", sd=1e-6, offset_sd=10.0)
    means = []
    for seed in range(300):
        values = [o.value for o in draw(SampledRobot(shared, "cube", np.random.default_rng(seed)), "dip", 3)]
        assert np.ptp(values) < 1e-3
        means.append(values[0])
    assert stats.kstest(means, stats.norm(125.0, 10.0).cdf).pvalue > 1e-3


def test_a_hidden_label_is_repeated(network: Network) -> None:
    """Two looks agree with probability rho + (1 - rho) times the chance of agreement, given the state."""
    rho = 0.6
    shared = with_sensor(network, "knock", repeat_probability=rho)
    pairs = [draw(SampledRobot(shared, "cube", np.random.default_rng(seed)), "knock", 2) for seed in range(3000)]
    agree = sum(first == second for first, second in pairs)
    by_chance = float(np.sum(TABLE[:, 0] ** 2))
    expected = rho**2 + (1 - rho**2) * by_chance
    assert stats.binomtest(agree, 3000, expected).pvalue > 1e-3


def test_only_what_is_known_can_be_measured(network: Network) -> None:
    """Actions on properties whose truth is not given are not on offer."""
    robot = SampledRobot(network, {"stuff": "oak"}, np.random.default_rng(0))
    assert robot.actions() == ("look", "knock")
    with pytest.raises(EvidenceError, match="true 'side' is not known"):
        robot.perform("measure")


def test_the_seed_decides(network: Network) -> None:
    """The same seed gives the same outcomes."""
    one, same = (SampledRobot(network, "cube", np.random.default_rng(5)) for _ in range(2))
    assert draw(one, "dip", 5) == draw(same, "dip", 5)


@pytest.mark.parametrize(
    ("thing", "told"),
    [
        ("ball", "unknown object 'ball': choose from 'cube', 'fake'"),
        ({"colour": "red"}, "unknown property 'colour'"),
        ({"stuff": "tin"}, "true stuff 'tin' is no state; choose from 'oak'"),
        ({"side": float("nan")}, "true side nan was found"),
        ({"side": "long"}, "true side 'long' was found"),
    ],
)
def test_bad_truth_is_refused(network: Network, thing: Any, told: str) -> None:
    """Unknown objects, properties and states, and truths that are no numbers, are refused at once."""
    with pytest.raises(EvidenceError, match=told):
        SampledRobot(network, thing, np.random.default_rng(0))


def test_labels_are_labels(network: Network) -> None:
    """A look returns a Label of the sensor's outcomes."""
    assert isinstance(SampledRobot(network, "cube", np.random.default_rng(0)).perform("look"), Label)
