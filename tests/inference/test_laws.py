"""Laws of beliefs and of information, for any evidence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from palpate.errors import ImpossibleEvidenceError
from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.network.families import Normal
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Failed, Label, Likelihood, Outcome, Reading

Seen = tuple[str, Outcome]
NUMBERS = ("elasticity", "density", "volume", "mass")
QUADRATURE_BITS = 1e-4


@cache
def household() -> Network:
    return load_network("household")


@cache
def prior() -> ExactBelief:
    return ExactBelief(household())


def labels(action: str) -> st.SearchStrategy[Seen]:
    sensor = household().actions[action].sensor
    assert isinstance(sensor, ConfusionSensor)
    return st.sampled_from(sensor.outcomes).map(lambda label: (action, Label(label)))


def vectors(action: str) -> st.SearchStrategy[Seen]:
    prop = household().properties[household().actions[action].sensor.property]
    assert isinstance(prop, CategoricalProperty)
    weights = st.lists(st.floats(0.01, 1.0), min_size=len(prop.states), max_size=len(prop.states))
    return weights.map(lambda w: (action, Likelihood(dict(zip(prop.states, w, strict=True)))))


squeezes = st.one_of(st.floats(-20, 95).map(lambda y: ("squeezing", Reading(y))), st.just(("squeezing", Above(95.0))))
weighings = st.one_of(st.floats(-10, 3000), st.floats(0, 200)).map(lambda y: ("weighing", Reading(y)))
categorical = st.one_of(
    *map(labels, ("cat-vision", "mat-vision", "mat-sound")), vectors("cat-vision"), vectors("mat-sound")
)
observations: st.SearchStrategy[Seen] = st.one_of(categorical, squeezes, weighings)
evidence = st.lists(observations, max_size=5)


def believe(seen: Sequence[Seen]) -> ExactBelief:
    belief = prior()
    try:
        for action, outcome in seen:
            belief = belief.update(action, outcome)
    except ImpossibleEvidenceError:
        assume(False)
    return belief


def number(belief: ExactBelief, name: str) -> ContinuousMarginal:
    marginal = belief.marginal(name)
    assert isinstance(marginal, ContinuousMarginal)
    return marginal


@given(evidence, st.randoms())
@settings(max_examples=60, deadline=None)
def test_order_does_not_matter(seen: list[Seen], random: np.random.Generator) -> None:
    """The belief is the same, to 1e-10, in whatever order the evidence comes."""
    shuffled = list(seen)
    random.shuffle(shuffled)
    one, other = believe(seen), believe(shuffled)
    tables = [b.probabilities("category", "material") for b in (one, other)]
    assert np.abs(tables[0] - tables[1]).max() < 1e-10
    assert one.log_evidence_bits == pytest.approx(other.log_evidence_bits, abs=1e-8)
    for name in NUMBERS:
        a, b = number(one, name), number(other, name)
        assert (a.mean, a.sd) == pytest.approx((b.mean, b.sd), rel=1e-9, abs=1e-10)


@given(evidence, st.sampled_from(["cat-vision", "mat-vision"]), st.floats(0.01, 100))
@settings(max_examples=40, deadline=None)
def test_uniform_likelihood_changes_nothing(seen: list[Seen], action: str, level: float) -> None:
    """A likelihood that is the same for all states leaves the belief as it was, and so does a failure."""
    before = believe(seen)
    prop = household().properties[household().actions[action].sensor.property]
    assert isinstance(prop, CategoricalProperty)
    for after in (
        before.update(action, Likelihood(dict.fromkeys(prop.states, level))),
        before.update(action, Failed()),
    ):
        difference = after.probabilities("category", "material") - before.probabilities("category", "material")
        assert np.abs(difference).max() < 1e-12
        assert number(after, "mass").mean == pytest.approx(number(before, "mass").mean, rel=1e-12)
        assert after.log_evidence_bits == pytest.approx(before.log_evidence_bits, abs=1e-10)


FAR: list[list[Seen]] = [
    [("weighing", Reading(30_000.0))],
    [("weighing", Reading(-500.0))],
    [("squeezing", Reading(-400.0))],
    [("mat-sound", Label("foam")), ("weighing", Reading(20_000.0))],
    [("squeezing", Above(2000.0))],
    [("weighing", Reading(10.0, 0.01)), ("weighing", Reading(2500.0, 0.01))],
    [("weighing", Reading(118.0, 1e-3))],
    [("squeezing", Reading(60.0, 1e-3)), ("squeezing", Above(95.0))],
]


@pytest.mark.parametrize("seen", FAR)
def test_far_tails_stay_finite(seen: list[Seen]) -> None:
    """Readings far outside of all that is believed give finite answers inside the supports."""
    belief = believe(seen)
    table = belief.probabilities("category", "material")
    assert np.isfinite(table).all()
    assert table.sum() == pytest.approx(1.0, abs=1e-9)
    assert np.isfinite(belief.log_evidence_bits)
    for name in NUMBERS:
        marginal = number(belief, name)
        assert np.isfinite([marginal.mean, marginal.sd, marginal.entropy_bits]).all(), name
        assert marginal.quantile(0.05) >= 0
    for action, gains in belief.expected_gains().items():
        assert all(gain is not None and np.isfinite(gain) and gain >= 0 for gain in gains.values()), action


@given(st.floats(0.05, 50), st.floats(0.05, 50), st.floats(-100, 100), st.lists(st.floats(-2, 2), max_size=3))
@settings(max_examples=60, deadline=None)
def test_closed_form_of_normal_property_and_sensor(sd: float, noise: float, mean: float, zs: list[float]) -> None:
    """For a normal property and sensor the gain is 0.5 log2(1 + s^2/n^2), and updates are conjugate."""
    family = Normal(np.array(mean), np.array(sd), np.array(-np.inf), np.array(np.inf))
    prop = ContinuousProperty("height", "m", (), family)
    network = Network("one", {"height": prop}, {"look": Action("look", 1.0, NumberSensor("height", noise))})
    belief, precision, weighted = ExactBelief(network), sd**-2, mean * sd**-2
    for z in zs:
        y = mean + z * float(np.hypot(sd, noise))
        belief = belief.update("look", Reading(y))
        precision, weighted = precision + noise**-2, weighted + y * noise**-2
    gains, s = belief.expected_gains()["look"], precision**-0.5
    expected = 0.5 * np.log2(1 + (s / noise) ** 2)
    assert gains["height"] == pytest.approx(expected, abs=1e-3)
    assert gains["everything"] == pytest.approx(expected, abs=1e-3)
    marginal = number(belief, "height")
    assert marginal.mean == pytest.approx(weighted / precision, abs=1e-3 * s)
    assert marginal.sd == pytest.approx(s, rel=1e-3)
    assert marginal.entropy_bits == pytest.approx(np.log2(s * np.sqrt(2 * np.pi * math.e)), abs=1e-3)


SUBSETS = [
    (("category",), ("category", "material")),
    (("material",), ("category", "material")),
    (("elasticity",), ("material", "elasticity")),
    (("density",), ("density", "volume")),
    (("mass",), ("density", "mass")),
    (("category", "material"), ("category", "material", "elasticity")),
]


@given(evidence)
@settings(max_examples=25, deadline=None)
def test_gains_are_ordered(seen: list[Seen]) -> None:
    """Gains are never negative, grow with the objective, and everything tells what the parent tells."""
    gains = believe(seen).expected_gains(
        [*household().properties, "everything", *(b for _, b in SUBSETS), ("category",)]
    )
    for action, told in gains.items():
        bits = {k: v for k, v in told.items() if v is not None}
        assert len(bits) == len(told)
        assert min(bits.values()) >= 0
        parent = household().actions[action].sensor.property
        assert bits["everything"] == pytest.approx(bits[parent], abs=1e-3)
        assert max(bits.values()) <= bits["everything"] + 1e-3
        for part, whole in SUBSETS:
            assert bits[part if len(part) > 1 else part[0]] <= bits[whole] + 1e-3, (action, part, whole)


@given(evidence)
@settings(max_examples=40, deadline=None)
def test_data_processing_inequality(seen: list[Seen]) -> None:
    """Without a weighing, an action on category tells no more about elasticity than about material."""
    belief = believe([s for s in seen if s[0] != "weighing"])
    told = belief.expected_gains(["material", "category", "elasticity", "density", "volume"])
    assert (told["cat-vision"]["elasticity"] or 0) <= (told["cat-vision"]["material"] or 0) + QUADRATURE_BITS
    assert (told["cat-vision"]["density"] or 0) <= (told["cat-vision"]["material"] or 0) + QUADRATURE_BITS
    for action in ("mat-vision", "mat-sound", "squeezing"):
        assert (told[action]["volume"] or 0) <= (told[action]["category"] or 0) + QUADRATURE_BITS


@given(evidence, st.sampled_from(["mat-vision", "cat-vision", "mat-sound"]))
@settings(max_examples=25, deadline=None)
def test_chain_rule(seen: list[Seen], action: str) -> None:
    """I(C, M; Y) = I(C; Y) + I(M; Y | C), the last from beliefs in which the category is known."""
    belief = believe(seen)
    told = belief.expected_gains([("category", "material"), "category"], [action])[action]
    prop, conditional = household().categorical[0], 0.0
    for state, p in zip(prop.states, belief.probabilities("category"), strict=True):
        if p > 1e-12:
            known = Likelihood({s: float(s == state) for s in prop.states})
            conditional += p * (
                belief.update("cat-vision", known).expected_gains(["material"], [action])[action]["material"] or 0.0
            )
    joint = told["category", "material"]
    assert joint == pytest.approx((told["category"] or 0.0) + conditional, abs=1e-6)


MEANS: list[tuple[list[Seen], str]] = [
    ([], "mat-sound"),
    ([("cat-vision", Label("mug"))], "squeezing"),
    ([("mat-vision", Label("foam"))], "weighing"),
    ([("weighing", Reading(118.0))], "mat-sound"),
]


def draw(
    prediction: LabelPrediction | NumberPrediction, belief: ExactBelief, action: str, rng: np.random.Generator
) -> Outcome:
    """An outcome from the belief: an object drawn from it, and the sensor's noise added here."""
    if isinstance(prediction, LabelPrediction):
        return Label(str(rng.choice(prediction.outcomes, p=prediction.probabilities / prediction.probabilities.sum())))
    sensor = household().actions[action].sensor
    assert isinstance(sensor, NumberSensor)
    value = float(belief.sample(1, rng)[sensor.property][0]) + sensor.sd * float(rng.standard_normal())
    return Above(sensor.high) if value > sensor.high else Reading(value)


@pytest.mark.parametrize(("seen", "action"), MEANS)
def test_mean_realised_gain_is_the_expected_gain(seen: list[Seen], action: str) -> None:
    """The mean realised gain over simulated outcomes is the expected gain, within 4.5 standard errors."""
    belief, rng = believe(seen), np.random.default_rng(7)
    objectives = ("category", "material", "elasticity", "mass")
    realised = np.empty((400, len(objectives)))
    prediction = belief.predict(action)
    for row in realised:
        after = belief.update(action, draw(prediction, belief, action, rng))
        row[:] = [belief.realised_gain(after, objective) for objective in objectives]
    assert realised.min() >= -1e-6
    expected = belief.expected_gains(objectives, [action])[action]
    for k, objective in enumerate(objectives):
        error = realised[:, k].std() / np.sqrt(len(realised))
        assert abs(realised[:, k].mean() - (expected[objective] or 0.0)) < 4.5 * error + 1e-3, objective
