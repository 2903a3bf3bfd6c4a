import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.errors import EvidenceError
from palpate.network.admission import StateLikelihood, admit
from palpate.network.families import LogNormal
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading

STATES = ("oak", "clay", "wool", "cork")


def one(value: float) -> np.ndarray:
    return np.array(value)


@pytest.fixture
def network() -> Network:
    stuff = CategoricalProperty("stuff", STATES, (), np.full(4, 0.25))
    weight = ContinuousProperty("weight", "g", (), LogNormal(one(50.0), one(0.5)))
    look = ConfusionSensor("stuff", ("oaken", "other"), np.array([[0.9, 0.1, 0.1, 0.1], [0.1, 0.9, 0.9, 0.9]]))
    scales = NumberSensor("weight", 5.0, low=1.0, high=95.0)
    actions = {"look": Action("look", 1.0, look), "weigh": Action("weigh", 5.0, scales)}
    return Network("toy", {"stuff": stuff, "weight": weight}, actions)


def vector(network: Network, outcome: Likelihood | Posterior) -> np.ndarray:
    admitted = admit(network, "look", outcome).outcome
    assert isinstance(admitted, StateLikelihood)
    return admitted.values


def test_label_of_the_sensor_is_admitted(network: Network) -> None:
    """A label is one of the sensor's outcomes, which need not be states."""
    assert admit(network, "look", Label("oaken")).outcome == Label("oaken")


@pytest.mark.parametrize(
    ("action", "outcome", "told"),
    [
        ("lift", Label("oaken"), "unknown action 'lift': choose from 'look', 'weigh'"),
        ("look", Label("oak"), r"unknown label 'oak' \(did you mean 'oaken'\?\); choose from 'oaken', 'other'"),
        ("look", Reading(3.0), "Reading was found.*expected Label, Likelihood, Posterior or Failed"),
        ("weigh", Label("oaken"), "Label was found.*expected Reading, Above, Below or Failed"),
        ("weigh", 3.0, "float was found"),
        ("weigh", Reading(math.nan), "value nan was found, expected a finite number"),
        ("weigh", Reading(math.inf), "value inf"),
        ("weigh", Reading(True), "value True"),
        ("weigh", Reading(3.0, sd=0.0), "sd 0.0 was found, expected a number above zero"),
        ("weigh", Reading(3.0, sd=-1.0), "sd -1.0"),
        ("weigh", Above(math.nan), "above nan"),
        ("weigh", Below(math.inf), "below inf"),
        ("look", Likelihood({"oak": 1.0}), "does not name 'clay', 'wool', 'cork', expected every state of 'stuff'"),
        ("look", Likelihood(dict.fromkeys(STATES, 0.0)), "zero for every state"),
        ("look", Likelihood({**dict.fromkeys(STATES, 1.0), "tin": 1.0}), "names 'tin', no state of 'stuff'; choose"),
        ("look", Likelihood({**dict.fromkeys(STATES, 1.0), "oak": -0.1}), "likelihood of 'oak' -0.1"),
        ("look", Posterior({"oak": math.nan}), "posterior of 'oak' nan"),
        ("look", Posterior({"oak": 0.0}), "sums to 0, expected one"),
        ("look", Posterior({}), "sums to 0, expected one"),
        ("look", Posterior({"oak": 1.0}, temperature=0.0), "temperature 0"),
        ("look", Posterior({"oak": 1.0}, temperature=math.nan), "temperature nan"),
        ("look", Posterior({"oak": 1.0}, {"oak": 1.0}), "training prior does not name 'clay', 'wool', 'cork'"),
        ("look", Posterior({"oak": 1.0}, {**dict.fromkeys(STATES, 0.3), "wool": 0}), "training prior of 'wool' is 0"),
        ("look", StateLikelihood(np.ones(3)), "vector of shape"),
    ],
)
def test_bad_outcome_is_one_sentence(network: Network, action: str, outcome: Any, told: str) -> None:
    """What cannot be admitted is an EvidenceError of one sentence that says what would be right."""
    with pytest.raises(EvidenceError, match=told) as caught:
        admit(network, action, outcome)
    assert "\n" not in str(caught.value)


def test_failed_is_admitted_by_every_action(network: Network) -> None:
    """A failed reading says nothing and fits every sensor."""
    assert admit(network, "look", Failed("dark")).outcome == Failed("dark")
    assert admit(network, "weigh", Failed()).outcome == Failed()


def test_reading_beyond_saturation_is_a_bound(network: Network) -> None:
    """A value beyond either end of the sensor's range is read as a bound, with a notice."""
    high = admit(network, "weigh", Reading(120.0, sd=2.0))
    assert high.outcome == Above(95.0, 2.0)
    assert high.notices == ("action 'weigh': 120 g is beyond saturation and is read as above 95 g",)
    assert admit(network, "weigh", Reading(0.5)).outcome == Below(1.0)


def test_reading_at_saturation_is_a_reading(network: Network) -> None:
    """A value equal to the end of the range is still a reading."""
    admitted = admit(network, "weigh", Reading(95.0))
    assert admitted.outcome == Reading(95.0)
    assert admitted.notices == ()


def test_units_are_converted(network: Network) -> None:
    """Value and sd come out in the property's unit, before saturation is looked at."""
    reading = admit(network, "weigh", Reading(0.09, 0.001, "kg")).outcome
    assert isinstance(reading, Reading)
    assert reading.value == pytest.approx(90)
    assert reading.sd == pytest.approx(1)
    assert reading.unit is None
    assert admit(network, "weigh", Reading(90.0, unit="g")).outcome == Reading(90.0)
    assert admit(network, "weigh", Reading(0.2, unit="kg")).outcome == Above(95.0)
    above = admit(network, "weigh", Above(0.05, unit="kg")).outcome
    assert isinstance(above, Above)
    assert above.bound == pytest.approx(50)


@pytest.mark.parametrize("unit", ["kPa", "smoots", ""])
def test_unit_of_wrong_dimension_is_refused(network: Network, unit: str) -> None:
    """A unit of another dimension, or none that is known, is an EvidenceError naming the action."""
    with pytest.raises(EvidenceError, match="'weigh'"):
        admit(network, "weigh", Reading(3.0, unit=unit))


def test_posterior_spreads_unknown_labels(network: Network) -> None:
    """Mass on labels that are no states goes evenly to the states that hold nothing."""
    values = vector(network, Posterior({"oak": 0.5, "clay": 0.2, "tin": 0.2, "jade": 0.1}))
    assert values == pytest.approx([1, 0.4, 0.3, 0.3])


def test_posterior_drops_unknown_labels_where_all_states_hold_mass(network: Network) -> None:
    """Where every state holds mass of its own, mass on unknown labels is dropped."""
    admitted = admit(network, "look", Posterior({"oak": 0.3, "clay": 0.3, "wool": 0.15, "cork": 0.15, "tin": 0.1}))
    assert isinstance(admitted.outcome, StateLikelihood)
    assert admitted.outcome.values == pytest.approx([1, 1, 0.5, 0.5])
    assert any("is dropped" in notice for notice in admitted.notices)


def test_posterior_is_tempered_then_divided_by_its_prior(network: Network) -> None:
    """The likelihood is p^(1/T) / training prior, scaled to a maximum of one."""
    given_prior = {"oak": 0.4, "clay": 0.3, "wool": 0.2, "cork": 0.1}
    values = vector(network, Posterior({"oak": 0.64, "clay": 0.16, "wool": 0.16, "cork": 0.04}, given_prior, 2.0))
    expected = np.array([0.8 / 0.4, 0.4 / 0.3, 0.4 / 0.2, 0.2 / 0.1])
    assert values == pytest.approx(expected / 2.0)


def test_posterior_is_floored(network: Network) -> None:
    """A classifier that excludes a state is believed down to 1e-3 only, with a notice."""
    admitted = admit(network, "look", Posterior({"oak": 1.0}))
    assert isinstance(admitted.outcome, StateLikelihood)
    assert admitted.outcome.values == pytest.approx([1, 1e-3, 1e-3, 1e-3])
    assert any("0.001" in notice for notice in admitted.notices)


def test_likelihood_is_not_floored(network: Network) -> None:
    """A likelihood vector is used as it is, zeros included."""
    assert vector(network, Likelihood({"oak": 4.0, "clay": 0.0, "wool": 1.0, "cork": 2.0})) == pytest.approx(
        [1, 0, 0.25, 0.5]
    )


@given(st.lists(st.floats(1e-3, 1.0), min_size=4, max_size=4), st.floats(0.01, 100.0))
def test_scale_of_a_likelihood_does_not_matter(weights: list[float], factor: float) -> None:
    """Likelihoods that differ by a factor are admitted as the same vector."""
    stuff = CategoricalProperty("stuff", STATES, (), np.full(4, 0.25))
    look = Action("look", 1.0, ConfusionSensor("stuff", STATES, np.eye(4)))
    network = Network("toy", {"stuff": stuff}, {"look": look})
    plain = vector(network, Likelihood(dict(zip(STATES, weights, strict=True))))
    scaled = vector(network, Likelihood(dict(zip(STATES, [w * factor for w in weights], strict=True))))
    assert plain == pytest.approx(scaled)
    assert plain.max() == 1


def test_admission_is_idempotent(network: Network) -> None:
    """What was admitted once is admitted again as it is, without notices."""
    outcomes: list[tuple[str, Outcome]] = [
        ("look", Posterior({"oak": 0.9, "tin": 0.1})),
        ("weigh", Reading(0.2, unit="kg")),
    ]
    for action, outcome in outcomes:
        first = admit(network, action, outcome).outcome
        again = admit(network, action, first)
        assert again.outcome == first
        assert again.notices == ()
