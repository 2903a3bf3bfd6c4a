"""The exact belief: what it accepts, what it refuses, and what it predicts."""

from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson, quad

from palpate.errors import EvidenceError, ImpossibleEvidenceError
from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.network.families import Uniform
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor, NumberSensor, Sensor
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Posterior, Reading

PRIOR = np.array([0.5, 0.3, 0.2])
SURE = np.array([[1.0, 0.0, 0.2], [0.0, 1.0, 0.8]])
LOOK = np.array([[0.7, 0.2, 0.1], [0.2, 0.6, 0.1], [0.1, 0.2, 0.8]])
RHO = 0.7


def toy() -> ExactBelief:
    """Zeros in a table and in a support, and a sensor that repeats itself."""
    kind = CategoricalProperty("kind", ("a", "b", "c"), (), PRIOR)
    length = ContinuousProperty(
        "length", "cm", ("kind",), Uniform(np.array([0.0, 10.0, 20.0]), np.array([5.0, 15.0, 25.0]))
    )
    sensors: dict[str, Sensor] = {
        "test": ConfusionSensor("kind", ("yes", "no"), SURE),
        "look": ConfusionSensor("kind", ("a", "b", "c"), LOOK, RHO),
        "rule": NumberSensor("length", 0.5, low=1.0, high=24.0),
    }
    actions = {name: Action(name, 1.0, sensor) for name, sensor in sensors.items()}
    return ExactBelief(Network("toy", {"kind": kind, "length": length}, actions))


@cache
def prior(name: str) -> ExactBelief:
    return ExactBelief(load_network(name))


REFUSED: list[tuple[str, Any, str]] = [
    ("licking", Label("mug"), "unknown action 'licking': choose from 'cat-vision', 'mat-vision'"),
    ("cat-vision", Label("kettle"), "action 'cat-vision': unknown label 'kettle'"),
    ("cat-vision", Reading(3.0), "action 'cat-vision': Reading was found, but it measures states of 'category'"),
    ("cat-vision", Likelihood({"mug": 1.0}), "action 'cat-vision'"),
    ("cat-vision", Likelihood({"kettle": 1.0}), "action 'cat-vision'"),
    ("cat-vision", Posterior({"mug": -0.2}), "action 'cat-vision'"),
    ("weighing", Label("mug"), r"action 'weighing': Label was found, but it measures a number \[g\]"),
    ("weighing", Reading(float("nan")), "action 'weighing': value nan was found, expected a finite number"),
    ("weighing", Reading(3.0, -1.0), "action 'weighing': sd -1.0 was found, expected a number above zero"),
    ("weighing", Reading(3.0, unit="kPa"), "action 'weighing'.*kPa"),
    ("weighing", Above(3.0, unit="spoonful"), "action 'weighing'.*spoonful"),
    ("weighing", None, "action 'weighing': NoneType was found"),
]


@pytest.mark.parametrize(("action", "outcome", "told"), REFUSED)
def test_what_does_not_fit_is_refused(action: str, outcome: Any, told: str) -> None:
    """Unknown actions, labels and units and outcomes of the wrong kind are refused in one sentence by each question."""
    belief = prior("household")
    for ask in (belief.update, belief.log2_predictive, belief.surprise):
        with pytest.raises(EvidenceError, match=told):
            ask(action, outcome)
    assert belief.evidence == ()


def test_units_are_converted() -> None:
    """A reading and its noise in another unit are the same reading."""
    one = prior("household").update("weighing", Reading(0.118, 0.004, "kg"))
    other = prior("household").update("weighing", Reading(118.0, 4.0))
    assert one.probabilities("material") == pytest.approx(other.probabilities("material"), rel=1e-12)
    assert one.log_evidence_bits == pytest.approx(other.log_evidence_bits, abs=1e-12)


def test_a_belief_is_a_value() -> None:
    """Updating leaves the old belief as it was, and the same update gives the same belief."""
    belief, outcome = toy(), Label("yes")
    before = belief.probabilities("kind").copy()
    first = belief.update("test", outcome)
    other = belief.update("test", Label("no"))
    again = belief.update("test", outcome)
    assert (belief.probabilities("kind") == before).all()
    assert belief.evidence == ()
    assert (first.probabilities("kind") == again.probabilities("kind")).all()
    assert first.probabilities("kind") == pytest.approx(PRIOR * SURE[0] / (PRIOR @ SURE[0]))
    assert other.probabilities("kind") == pytest.approx(PRIOR * SURE[1] / (PRIOR @ SURE[1]))


IMPOSSIBLE: list[tuple[list[tuple[str, Any]], str]] = [
    (
        [("test", Label("yes")), ("look", Likelihood({"a": 0.0, "b": 1.0, "c": 0.0}))],
        r"observation 2 \(look: .*\) has probability zero",
    ),
    (
        [("look", Label("a")), ("test", Label("no")), ("look", Likelihood({"a": 1.0, "b": 0.0, "c": 0.0}))],
        r"observation 3 \(look: ",
    ),
    (
        [
            ("look", Likelihood({"a": 1.0, "b": 0.0, "c": 0.0})),
            ("rule", Failed("slipped")),
            ("test", Label("yes")),
            ("test", Label("no")),
        ],
        r"observation 4 \(test: Label\(label='no'\)\) has probability zero",
    ),
]


@pytest.mark.parametrize(("seen", "told"), IMPOSSIBLE)
def test_impossible_evidence_names_the_observation(seen: list[tuple[str, Any]], told: str) -> None:
    """Evidence that contradicts zeros in tables is an error with the number and outcome of the last one."""
    belief = toy()
    for action, outcome in seen[:-1]:
        belief = belief.update(action, outcome)
    before = belief.probabilities("kind").copy()
    with pytest.raises(ImpossibleEvidenceError, match=told):
        belief.update(*seen[-1])
    assert (belief.probabilities("kind") == before).all()
    assert len(belief.evidence) == len(seen) - 1


def test_zeros_of_the_prior_stay_zero() -> None:
    """What a table rules out stays ruled out, and contradicting it is impossible evidence."""
    belief = prior("pantry")
    table = belief.probabilities("kind", "ripeness")
    assert (table[:2, 0] == 0).all()
    assert (table[2:, 1:] == 0).all()
    states = belief.network.categorical[2].states
    none = belief.update("sniff", Likelihood({s: float(s == "none") for s in states}))
    assert none.probabilities("kind")[:2].tolist() == [0, 0]
    kinds = belief.network.categorical[0].states
    with pytest.raises(ImpossibleEvidenceError, match=r"observation 2 \(look: "):
        none.update("look", Likelihood({k: float(k == "peach") for k in kinds}))


def test_a_failure_teaches_nothing_but_is_kept() -> None:
    """A failed action leaves the belief as it is and stands in the evidence."""
    belief = toy().update("look", Label("b")).update("rule", Reading(12.0))
    after = belief.update("rule", Failed("slipped"))
    assert (after.probabilities("kind") == belief.probabilities("kind")).all()
    assert [(seen.action, seen.outcome) for seen in after.evidence] == [
        ("look", Label("b")),
        ("rule", Reading(12.0)),
        ("rule", Failed("slipped")),
    ]
    assert belief.log2_predictive("rule", Failed()) == 0.0
    assert belief.surprise("rule", Failed()) is None
    assert belief.realised_gain(after, "everything") == pytest.approx(0.0, abs=1e-12)


def chain(labels: list[int]) -> Any:
    """p(labels | state) of a sensor that repeats a hidden label, by the states it may be in."""
    total = np.zeros(3)
    for hidden in range(3):
        term = LOOK[hidden].copy()
        for label in labels:
            term *= RHO * (label == hidden) + (1 - RHO) * LOOK[label]
        total += term
    return total


@given(st.lists(st.integers(0, 2), min_size=1, max_size=6))
@settings(max_examples=40)
def test_labels_that_repeat_a_hidden_one(labels: list[int]) -> None:
    """Repeated looks count as the hidden label says, for the belief, the evidence and the next prediction."""
    belief, names = toy(), "abc"
    for label in labels:
        belief = belief.update("look", Label(names[label]))
    joint = PRIOR * chain(labels)
    assert belief.probabilities("kind") == pytest.approx(joint / joint.sum(), rel=1e-10)
    assert belief.log_evidence_bits == pytest.approx(np.log2(joint.sum()), abs=1e-10)
    prediction = belief.predict("look")
    assert isinstance(prediction, LabelPrediction)
    expected = [float(PRIOR @ chain([*labels, y])) / joint.sum() for y in range(3)]
    assert prediction.probabilities == pytest.approx(expected, rel=1e-10)
    for y, p in enumerate(expected):
        assert belief.log2_predictive("look", Label(names[y])) == pytest.approx(np.log2(p), abs=1e-9)
        alike = sum(q for q in expected if q <= p * (1 + 1e-9))
        assert belief.surprise("look", Label(names[y])) == pytest.approx(min(1.0, alike), rel=1e-9)


def test_repeated_labels_saturate() -> None:
    """Twenty equal looks by a sensor that repeats itself do not make certain what twenty fresh ones would."""
    belief = toy()
    for _ in range(20):
        belief = belief.update("look", Label("a"))
    # in the limit all that is known is that the hidden label is a, or that fresh draws always were
    assert 0.7 < belief.probabilities("kind")[0] < 0.999
    prediction = belief.predict("look")
    assert isinstance(prediction, LabelPrediction)
    assert prediction.probabilities[0] > RHO


PREDICTED: list[tuple[str, list[tuple[str, Any]], str, float | None]] = [
    ("household", [], "weighing", None),
    ("household", [("cat-vision", Label("mug"))], "squeezing", None),
    ("household", [("weighing", Reading(118.0))], "weighing", None),
    ("household", [], "squeezing", 1.0),
    ("pantry", [], "press", None),
    ("pantry", [("look", Label("bottle"))], "ring", None),
    ("pantry", [("weigh", Reading(200.0))], "weigh", None),
    ("pantry", [("weigh", Reading(200.0))], "thermometer", None),
]


@pytest.mark.parametrize(("network", "seen", "action", "sd"), PREDICTED)
def test_predicted_readings_have_mass_one(
    network: str, seen: list[tuple[str, Any]], action: str, sd: float | None
) -> None:
    """The density between the ends and the atoms at them have mass one, and the distribution function is theirs."""
    belief = prior(network)
    for name, outcome in seen:
        belief = belief.update(name, outcome)
    prediction = belief.predict(action, sd)
    assert isinstance(prediction, NumberPrediction)
    sensor = belief.network.actions[action].sensor
    assert isinstance(sensor, NumberSensor)
    marginal = belief.marginal(sensor.property)
    assert isinstance(marginal, ContinuousMarginal)
    noise = float(sensor.scale(marginal.nodes[:1], sd)[0])
    reach = 40 * float(sensor.scale(marginal.nodes[-1:], sd)[0]) + 10 * sensor.offset_sd
    low, high = max(sensor.low, marginal.nodes[0] - reach), min(sensor.high, marginal.nodes[-1] + reach)
    y = np.linspace(low, high, int(3 * (high - low) / noise))
    density = prediction.density(y)
    assert (density >= 0).all()
    cumulative = cumulative_simpson(density, x=y, initial=0.0)
    assert cumulative[-1] + prediction.below + prediction.above == pytest.approx(1.0, abs=2e-4)
    for k in (len(y) // 50, len(y) // 7, len(y) // 2):
        assert prediction.cdf(y[k]) == pytest.approx(prediction.below + cumulative[k], abs=2e-4)


def test_atoms_are_where_the_sensor_saturates() -> None:
    """Beyond the ends there is no density; the distribution function starts with one atom and ends with the other."""
    prediction = toy().predict("rule")
    assert isinstance(prediction, NumberPrediction)
    assert prediction.density(np.array([0.9, 24.1])).tolist() == [0, 0]
    assert prediction.cdf(0.999) == 0
    assert prediction.cdf(1.0) == pytest.approx(prediction.below)
    assert prediction.cdf(24.001) == 1
    assert prediction.cdf(24.0) == pytest.approx(1 - prediction.above)
    # a length below 1 is a fifth of kind a's, above 24 a fifth of kind c's; noise is even about both ends
    assert prediction.below == pytest.approx(0.5 * 0.2, abs=1e-2)
    assert prediction.above == pytest.approx(0.2 * 0.2, abs=1e-2)


@pytest.mark.parametrize("value", [2.0, 4.9, 12.0, 21.0])
def test_predictive_density_is_bayes_rule(value: float) -> None:
    """The density of a reading, the sum over kinds by hand, is what the evidence says and what is predicted."""
    belief = toy()
    lows, highs = (0.0, 10.0, 20.0), (5.0, 15.0, 25.0)

    def normal(x: float) -> float:
        return float(np.exp(-0.5 * ((value - x) / 0.5) ** 2) / (0.5 * np.sqrt(2 * np.pi)))

    by_kind = [
        p * quad(normal, low, high, points=[value] if low < value < high else None)[0] / 5
        for p, low, high in zip(PRIOR, lows, highs, strict=True)
    ]
    prediction = belief.predict("rule")
    assert isinstance(prediction, NumberPrediction)
    assert float(prediction.density(value)) == pytest.approx(sum(by_kind), rel=1e-3)
    assert belief.log2_predictive("rule", Reading(value)) == pytest.approx(np.log2(sum(by_kind)), abs=1e-3)
    after = belief.update("rule", Reading(value)).probabilities("kind")
    assert after == pytest.approx(np.array(by_kind) / sum(by_kind), abs=1e-4)


def test_surprise_of_readings_is_a_tail() -> None:
    """The surprise of a reading is twice the smaller tail of the prediction; a bound is an outermost outcome."""
    belief = toy()
    prediction = belief.predict("rule")
    assert isinstance(prediction, NumberPrediction)
    for value in (2.0, 4.0, 11.0, 20.0):
        tail = min(float(prediction.cdf(value)), 1 - float(prediction.cdf(value)))
        assert belief.surprise("rule", Reading(value)) == pytest.approx(2 * tail, abs=1e-3)
    assert belief.surprise("rule", Below(1.0)) == pytest.approx(2 * prediction.below, abs=1e-3)
    assert belief.surprise("rule", Reading(30.0)) == pytest.approx(2 * prediction.above, abs=1e-3)
    assert belief.surprise("look", Likelihood({"a": 1.0, "b": 0.5, "c": 0.5})) is None


ASKED: list[tuple[Any, str]] = [
    (["colour"], "unknown property 'colour': choose from 'category', 'material'"),
    ([("category", "colour")], "unknown property 'colour'"),
    ([()], "an objective names no property: choose from .*'everything'"),
    (["Everything"], "unknown property 'Everything'"),
]


@pytest.mark.parametrize(("objectives", "told"), ASKED)
def test_unknown_objectives_are_refused(objectives: Any, told: str) -> None:
    """An objective that names what the network does not have, or nothing, is refused, expected and realised."""
    belief = prior("household")
    with pytest.raises(EvidenceError, match=told):
        belief.expected_gains(objectives)
    after = belief.update("cat-vision", Label("mug"))
    for objective in objectives:
        with pytest.raises(EvidenceError, match=told):
            belief.realised_gain(after, objective)


def test_unknown_actions_and_properties_are_refused() -> None:
    """Each question about what the network does not have lists what it has."""
    belief = prior("household")
    for ask in (lambda: belief.expected_gains(None, ["licking"]), lambda: belief.predict("licking")):
        with pytest.raises(EvidenceError, match="unknown action 'licking': choose from"):
            ask()
    with pytest.raises(EvidenceError, match="unknown property 'colour': choose from"):
        belief.marginal("colour")
    with pytest.raises(EvidenceError, match=r"'mass' is not categorical and has no table.* choose from 'category'"):
        belief.probabilities("category", "mass")


def test_gains_are_given_for_what_was_asked() -> None:
    """Objectives and actions come back as they were given, all of them where none were."""
    belief = prior("household")
    asked: list[Any] = ["mass", ("mass", "category"), ("category", "mass"), "everything"]
    gains = belief.expected_gains(asked, ["weighing", "cat-vision"])
    assert list(gains) == ["weighing", "cat-vision"]
    assert all(list(row) == asked for row in gains.values())
    assert gains["weighing"]["mass", "category"] == pytest.approx(gains["weighing"]["category", "mass"])
    everything = belief.expected_gains()
    assert list(everything) == list(belief.network.actions)
    assert all(list(row) == [*belief.network.properties, "everything"] for row in everything.values())
    assert belief.expected_gains(["mass"], []) == {}


def test_tables_have_the_axes_asked_for() -> None:
    """Joint tables come with an axis per property in the order asked for, and sum to one."""
    belief = toy().update("look", Label("a"))
    assert belief.probabilities() == pytest.approx(1.0)
    household = prior("household")
    one, other = household.probabilities("category", "material"), household.probabilities("material", "category")
    assert other == pytest.approx(one.T)
    assert one.sum() == pytest.approx(1.0)


def test_gains_after_labels_are_by_enumeration() -> None:
    """The gain of another look, given those before, is that of the labels' joint probabilities."""
    for seen in product(range(3), repeat=2):
        belief = toy()
        for label in seen:
            belief = belief.update("look", Label("abc"[label]))
        joint = np.array([PRIOR * chain([*seen, y]) for y in range(3)])
        joint /= joint.sum()
        independent = joint.sum(axis=0)[None, :] * joint.sum(axis=1)[:, None]
        expected = float((joint * np.log2(joint / independent)).sum())
        gains = belief.expected_gains(["kind", "everything", "length"], ["look"])["look"]
        assert gains["kind"] == pytest.approx(expected, abs=1e-10)
        assert gains["everything"] == pytest.approx(expected, abs=1e-10)
        # kinds have lengths of their own
        assert gains["length"] == pytest.approx(expected, abs=1e-6)
