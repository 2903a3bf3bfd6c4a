"""The message-passing belief: the published figures, its known faults, and what it answers."""

import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.errors import EvidenceError, ImpossibleEvidenceError, PalpateError
from palpate.explore import explore
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.inference.message_passing import MessagePassingBelief, Settings
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.network.model import Action
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading
from palpate.robots.sampled import SampledRobot
from palpate.selection.objectives import Learn
from palpate.selection.stopping import NetGainBelow

HOUSEHOLD = load_network("household")
RELEASED, REPAIRED, WRITTEN = Settings.as_released(), Settings.repaired(), Settings.as_written()
NODES = ("material", "category", "density", "elasticity", "volume")

START = {
    "mat-vision": (0.837, 0.598, 0.668, 0.596, 0.669),
    "mat-sound": (1.544, 0.526, 0.912, 0.387, 0.453),
    "cat-vision": (0.611, 2.246, 0.622, 0.919, 0.482),
    "weighing": (1.88, 0.54, 0.52, 0.44, 0.54),
    "squeezing": (1.22, 0.53, 0.79, 0.51, 0.60),
}
"""Expected gains of the released program at the start [bits], objectives in the order of NODES."""


def prior(how: Settings = RELEASED, seed: int = 0) -> MessagePassingBelief:
    return MessagePassingBelief(HOUSEHOLD, how, seed)


def number(belief: MessagePassingBelief, property: str) -> ContinuousMarginal:
    marginal = belief.marginal(property)
    assert isinstance(marginal, ContinuousMarginal)
    return marginal


def gains(belief: MessagePassingBelief, action: str) -> list[float | None]:
    return list(belief.expected_gains(NODES, [action])[action].values())


def uniform(property: str) -> Likelihood:
    marginal = prior().marginal(property)
    assert isinstance(marginal, CategoricalMarginal)
    return Likelihood(dict.fromkeys(marginal.states, 0.5))


def same(a: MessagePassingBelief, b: MessagePassingBelief) -> bool:
    return all(np.array_equal(a.beliefs[node], b.beliefs[node]) for node in NODES)


# -- the published figures ------------------------------------------------------------------


@pytest.mark.parametrize("how", [RELEASED, REPAIRED, WRITTEN])
@pytest.mark.parametrize("action", ["mat-vision", "mat-sound", "cat-vision"])
def test_start_gains_of_label_actions_are_the_programs(action: str, how: Settings) -> None:
    """Before any evidence labels promise what they promise in the released program, with every preset."""
    assert gains(prior(how), action) == pytest.approx(START[action], abs=6e-4)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("action", ["weighing", "squeezing"])
def test_start_gains_of_number_actions_are_the_programs(action: str, seed: int) -> None:
    """Before any evidence readings promise what they promise in the released program, but for the chance in EM."""
    assert gains(prior(seed=seed), action) == pytest.approx(START[action], abs=0.05)


def test_as_written_blurring_promises_to_know_less() -> None:
    """Without the extra multiplication squeezing has a negative gain for elasticity, weighing for density."""
    assert gains(prior(WRITTEN), "squeezing")[3] == pytest.approx(-0.12, abs=0.005)
    assert gains(prior(WRITTEN), "weighing")[2] == pytest.approx(-0.20, abs=0.005)


# -- the known faults, shown as such --------------------------------------------------------


def test_as_released_the_reading_of_a_weighing_has_no_effect() -> None:
    """With equal seeds 10 g and 1000 g give the same belief; repaired they do not."""
    light, heavy = (prior().update("weighing", Reading(g)) for g in (10.0, 1000.0))
    assert same(light, heavy)
    assert np.array_equal(light.beliefs["density"], prior().beliefs["density"])
    light, heavy = (prior(REPAIRED).update("weighing", Reading(g)) for g in (10.0, 1000.0))
    assert number(light, "density").mean < 0.5 * number(heavy, "density").mean


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_as_released_a_weighing_alone_tells_the_category(seed: int) -> None:
    """From the prior, messages about an unchanged density take category from uniform to P(box) = 0.26."""
    after = prior(seed=seed).update("weighing", Reading(100.0))
    states = HOUSEHOLD.categorical[0].states
    assert after.probabilities("category")[states.index("box")] == pytest.approx(0.26, abs=0.02)


def test_five_uniform_vectors_change_an_entropy() -> None:
    """Outcomes that say nothing move beliefs, as what is believed already is passed on as if it were news."""
    belief = prior()
    for _ in range(5):
        belief = belief.update("cat-vision", uniform("category"))
    assert belief.probabilities("category") == pytest.approx(0.1)
    assert belief.marginal("material").entropy_bits < prior().marginal("material").entropy_bits - 0.5


def test_the_order_of_evidence_matters() -> None:
    """The same two outcomes in another order give another belief."""
    steps: list[tuple[str, Outcome]] = [("cat-vision", Label("mug")), ("mat-sound", Label("foam"))]
    one, other = prior(), prior()
    for step, reverse in zip(steps, reversed(steps), strict=True):
        one, other = one.update(*step), other.update(*reverse)
    assert np.abs(one.probabilities("category") - other.probabilities("category")).max() > 0.01


# -- evidence -------------------------------------------------------------------------------


def test_a_label_is_a_softened_vector_at_its_node() -> None:
    """From a uniform prior a label leaves 99 % at its state and spreads 1 % evenly."""
    belief = prior().update("cat-vision", Label("mug"))
    expected = [0.99 if s == "mug" else 0.01 / 9 for s in HOUSEHOLD.categorical[0].states]
    assert belief.probabilities("category") == pytest.approx(expected)


def test_vectors_are_used_as_they_are_but_for_their_scale() -> None:
    """A likelihood is normalised and softened; a posterior counts as its likelihood."""
    states = HOUSEHOLD.categorical[1].states
    values = dict(zip(states, np.arange(1.0, 9.0), strict=True))
    vector = np.arange(1.0, 9.0) / 36
    expected = 0.99 * vector + 0.01 * (1 - vector) / 7
    assert prior().update("mat-vision", Likelihood(values)).probabilities("material") == pytest.approx(expected)
    assert prior().update("mat-vision", Posterior(values)).probabilities("material") == pytest.approx(expected)


@pytest.mark.parametrize("how", [RELEASED, REPAIRED])
@pytest.mark.parametrize(
    ("action", "outcome"), [("squeezing", Failed("slipped")), ("weighing", Failed()), ("weighing", Reading(1e9))]
)
def test_a_failed_measurement_changes_nothing(how: Settings, action: str, outcome: Outcome) -> None:
    """Failed, or a weight of which no density below the limit follows: beliefs and gains stay, evidence is kept."""
    before = prior(how).update("mat-vision", Label("glass"))
    after = before.update(action, outcome)
    assert same(before, after)
    assert gains(after, "squeezing") == gains(before, "squeezing")
    assert [seen.action for seen in after.evidence] == ["mat-vision", action]


def test_a_squeeze_above_cuts_the_density() -> None:
    """Nothing is left below the bound; above the whole grid nothing is left at all, which is an error."""
    marginal = number(prior().update("squeezing", Above(95.0)), "elasticity")
    assert (marginal.nodes[marginal.density > 0] > 95).all()
    with pytest.raises(ImpossibleEvidenceError, match=r"action 'squeezing': .*leaves 'elasticity' no probability"):
        prior().update("squeezing", Above(300.0))


def test_a_reading_may_carry_its_sd() -> None:
    """A sharper squeeze leaves less spread; repaired, the SD of a weighing matters too."""
    sharp, plain, blunt = (prior().update("squeezing", Reading(60.0, sd)) for sd in (1.0, None, 40.0))
    assert number(sharp, "elasticity").sd < number(plain, "elasticity").sd < number(blunt, "elasticity").sd
    sharp, blunt = (prior(REPAIRED).update("weighing", Reading(60.0, sd)) for sd in (1.0, 40.0))
    assert not same(sharp, blunt)


@pytest.mark.parametrize("outcome", [Above(100.0), Below(100.0)])
def test_a_bound_on_a_derived_property_is_refused(outcome: Outcome) -> None:
    """The method divides a reading by volumes and has nothing to do with a bound."""
    with pytest.raises(EvidenceError, match=r"action 'weighing': message passing has no use for .* of 'mass'"):
        prior().update("weighing", outcome)


def test_a_label_that_is_no_state_is_refused() -> None:
    """Where a sensor has other outcomes than states, a label of them cannot be made a vector, and gains are None."""
    looks = ConfusionSensor("material", ("shiny", "dull"), np.full((2, 8), 0.5))
    network = replace(HOUSEHOLD, actions={**HOUSEHOLD.actions, "look": Action("look", 1.0, looks)})
    belief = MessagePassingBelief(network)
    with pytest.raises(EvidenceError, match="action 'look': label 'shiny' is no state of 'material'"):
        belief.update("look", Label("shiny"))
    assert set(belief.expected_gains(actions=["look"])["look"].values()) == {None}


STEPS = st.lists(
    st.sampled_from(
        [
            ("cat-vision", Label("mug")),
            ("cat-vision", Posterior({"box": 0.7, "can": 0.3})),
            ("mat-vision", Label("metal")),
            ("mat-sound", Likelihood(dict.fromkeys(HOUSEHOLD.categorical[1].states, 1.0))),
            ("squeezing", Reading(40.0)),
            ("squeezing", Above(95.0)),
            ("weighing", Reading(118.0, 5.0)),
            ("weighing", Failed()),
        ]
    ),
    max_size=4,
)


@given(STEPS, st.sampled_from([RELEASED, REPAIRED, WRITTEN]))
@settings(max_examples=12, deadline=None)
def test_beliefs_stay_beliefs(steps: list[tuple[str, Outcome]], how: Settings) -> None:
    """After any evidence probabilities sum to one, densities integrate to one, and all gains of nodes are finite."""
    belief = prior(how)
    for action, outcome in steps:
        belief = belief.update(action, outcome)
    assert belief.probabilities("category", "material").sum() == pytest.approx(1)
    for node in ("elasticity", "density", "volume"):
        marginal = number(belief, node)
        assert marginal.masses.sum() == pytest.approx(1)
        assert marginal.quantile(0.05) < marginal.mean < marginal.quantile(0.99)
    for row in belief.expected_gains(NODES).values():
        assert np.isfinite([gain if gain is not None else np.nan for gain in row.values()]).all()


def test_results_repeat_whatever_is_asked_before() -> None:
    """Two beliefs with the same seed and evidence agree to the last digit, though only one was asked for gains."""
    steps: list[tuple[str, Outcome]] = [("squeezing", Reading(40.0)), ("weighing", Reading(90.0))]
    asked, silent = prior(REPAIRED), prior(REPAIRED)
    for step in steps:
        asked.expected_gains()
        asked, silent = asked.update(*step), silent.update(*step)
    assert same(asked, silent)
    assert asked.expected_gains(NODES) == silent.expected_gains(NODES, list(HOUSEHOLD.actions))
    other = prior(REPAIRED, seed=7).update(*steps[0])
    assert not same(other, prior(REPAIRED).update(*steps[0]))


# -- questions ------------------------------------------------------------------------------


def test_gains_of_several_are_sums_within_a_kind() -> None:
    """Categorical properties add up, continuous ones add up; the two kinds together, mass and everything are None."""
    row: Mapping[Any, float | None] = prior().expected_gains(
        [*NODES, ("category", "material"), ("density", "elasticity", "volume"), ("material", "density"), ("mass",)],
        ["mat-sound"],
    )["mat-sound"]
    single = {node: row[node] or 0.0 for node in NODES}
    assert row["category", "material"] == pytest.approx(single["category"] + single["material"])
    assert row["density", "elasticity", "volume"] == pytest.approx(
        single["density"] + single["elasticity"] + single["volume"]
    )
    assert row["material", "density"] is None
    assert row["mass",] is None
    everything = prior().expected_gains(actions=["mat-sound"])["mat-sound"]
    assert list(everything) == [*HOUSEHOLD.properties, "everything"]
    assert everything["mass"] is None
    assert everything["everything"] is None


@pytest.mark.parametrize(
    "ask",
    [
        lambda b: b.expected_gains(["colour"]),
        lambda b: b.expected_gains([()]),
        lambda b: b.expected_gains(actions=["licking"]),
        lambda b: b.realised_gain(b, "colour"),
        lambda b: b.marginal("colour"),
        lambda b: b.probabilities("density"),
        lambda b: b.predict("weighing"),
        lambda b: b.update("licking", Failed()),
        lambda b: b.surprise("cat-vision", Label("kettle")),
        lambda b: b.log2_predictive("cat-vision", Reading(3.0)),
    ],
)
def test_bad_questions_are_errors(ask: Any) -> None:
    """Unknown names, and questions to which there is no sensible answer, raise EvidenceError."""
    with pytest.raises(EvidenceError):
        ask(prior())


def test_realised_gain_is_the_divergence_of_a_marginal() -> None:
    """For one node KL(after || before) of its marginals; for several, or mass, None."""
    before = prior()
    after = before.update("mat-sound", Label("glass")).update("cat-vision", Label("mug"))
    p, q = after.probabilities("material"), before.probabilities("material")
    assert before.realised_gain(after, "material") == pytest.approx(float((p * np.log2(p / q)).sum()))
    f, g = number(after, "volume"), number(before, "volume")
    held = f.masses > 0
    divergence = float((f.masses[held] * np.log2(f.density[held] / g.density[held])).sum())
    assert before.realised_gain(after, ("volume",)) == pytest.approx(divergence)
    for objective in (("category", "material"), "mass", "everything"):
        assert before.realised_gain(after, objective) is None


def test_of_mass_and_of_log_evidence_nothing_is_said() -> None:
    """There is no node for mass and no probability of evidence."""
    assert np.isnan(number(prior(), "mass").mean)
    assert prior().log2_predictive("cat-vision", Label("mug")) is None
    assert prior().surprise("weighing", Reading(100.0)) is None


def test_labels_are_predicted_by_confusion_times_belief() -> None:
    """P(outcome) = C b; the surprise is what is no more probable."""
    belief = prior().update("mat-sound", Label("glass"))
    prediction = belief.predict("cat-vision")
    sensor = HOUSEHOLD.action("cat-vision").sensor
    assert isinstance(prediction, LabelPrediction)
    assert isinstance(sensor, ConfusionSensor)
    p = sensor.table @ belief.probabilities("category")
    assert prediction.probabilities == pytest.approx(p)
    seen = p[sensor.outcomes.index("box")]
    assert belief.surprise("cat-vision", Label("box")) == pytest.approx(p[p <= seen + 1e-12].sum())
    assert belief.surprise("cat-vision", uniform("category")) is None
    assert belief.surprise("cat-vision", Failed()) is None


def test_readings_are_predicted_from_the_marginal() -> None:
    """A squeeze's distribution is the marginal blurred by the noise; surprise is twice the smaller tail."""
    belief, rng = prior(), np.random.default_rng(5)
    prediction = belief.predict("squeezing")
    assert isinstance(prediction, NumberPrediction)
    readings = belief.sample(200_000, rng)["elasticity"].astype(float) + rng.normal(0, 10, 200_000)
    assert prediction.above == pytest.approx((readings > 95).mean(), abs=0.005)
    below = (readings <= 20).mean()
    assert belief.surprise("squeezing", Reading(20.0)) == pytest.approx(2 * min(below, 1 - below), abs=0.01)
    assert belief.surprise("squeezing", Above(95.0)) == pytest.approx(min(1, 2 * prediction.above))
    assert belief.surprise("squeezing", Below(0.0)) == pytest.approx(2 * (readings < 0).mean(), abs=0.01)


def test_samples_follow_the_marginals() -> None:
    """Draws come from each marginal on its own; derived properties follow from them by their formula."""
    belief = prior().update("cat-vision", Label("mug"))
    drawn = belief.sample(20_000, np.random.default_rng(2))
    assert list(drawn) == list(HOUSEHOLD.properties)
    assert (drawn["category"] == "mug").mean() == pytest.approx(0.99, abs=0.005)
    for name in ("elasticity", "density", "volume"):
        marginal = number(belief, name)
        assert drawn[name].astype(float).mean() == pytest.approx(marginal.mean, abs=4 * marginal.sd / 141)
    product = drawn["density"].astype(float) * drawn["volume"].astype(float) / 1000
    assert drawn["mass"].astype(float) == pytest.approx(product)


# -- with the rest of the package -----------------------------------------------------------


@pytest.mark.parametrize(
    ("wanted", "first"), [("material", "weighing"), ("category", "cat-vision"), ("elasticity", "cat-vision")]
)
def test_the_loop_takes_the_first_action_that_the_paper_reports(wanted: str, first: str) -> None:
    """Greedy with the engine's gains, without replacement, until the best gain is no more than zero."""
    robot = SampledRobot(HOUSEHOLD, "ceramic_mug", np.random.default_rng(1))
    *steps, last = explore(prior(), robot, objective=Learn(wanted), stopping=NetGainBelow(0.0))
    assert steps[0].action == first
    assert len({step.action for step in steps}) == len(steps)
    assert last.stop is not None
    assert max(last.gains_bits.values(), default=0.0) <= 0


def test_without_scikit_learn_nothing_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first belief already says what is missing."""
    monkeypatch.setitem(sys.modules, "sklearn.cluster", None)
    with pytest.raises(PalpateError, match="pip install"):
        prior()
