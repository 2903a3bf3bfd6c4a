"""How methods choose, on tapes of a small repertoire."""

from itertools import combinations

import numpy as np
import pytest

import palpate
from palpate.experiments.comparison.methods import (
    EXACT,
    AllOrders,
    BalancedOrders,
    ByPolicy,
    all_methods,
    best_sets,
    few_methods,
    methods_on_costs,
)
from palpate.experiments.comparison.trial import Trial
from palpate.experiments.comparison.worlds import worlds
from palpate.experiments.engines import Engine
from palpate.inference.belief import Belief
from palpate.information import entropy_bits
from palpate.network.sensors import ConfusionSensor
from palpate.selection.objectives import Learn
from palpate.selection.policies import FixedOrder

NETWORK = worlds()[0].believed


@pytest.fixture(scope="module")
def trial() -> Trial:
    (tape,) = worlds()[0].tapes(1, 0, 0, 1)
    costs_s = {name: action.cost_s for name, action in NETWORK.actions.items()}
    return Trial(NETWORK, tape, Learn("category", "material"), costs_s, seed=2)


def test_all_orders_are_as_likely(trial: Trial) -> None:
    """There are 120 different ones."""
    courses = AllOrders().courses(trial)
    assert len({course.actions for course in courses}) == 120
    assert {course.weight for course in courses} == {1 / 120}


def test_balanced_orders_put_each_action_at_each_place_once(trial: Trial) -> None:
    """They are a Latin square of weights that sum to one, the same whenever asked."""
    courses = BalancedOrders().courses(trial)
    for place in range(5):
        assert {course.actions[place] for course in courses} == set(trial.actions)
    assert sum(course.weight for course in courses) == pytest.approx(1)
    assert courses == BalancedOrders().courses(trial)


def test_a_policy_that_ends_ends_its_course(trial: Trial) -> None:
    """A fixed order of one action has one step, with the gains before and after it."""
    (course,) = ByPolicy(EXACT, FixedOrder(["weighing"])).courses(trial)
    assert course.actions == ("weighing",)
    assert course.steps == (0, 1)
    assert [set(gains) for gains in course.gains] == [set(trial.actions), set(trial.actions) - {"weighing"}]


def test_best_sets_by_enumeration_of_labels() -> None:
    """The best pair of labelling actions is that of the largest mutual information, summed over all labels."""
    network, names = NETWORK, ("cat-vision", "mat-vision", "mat-sound")
    prior = palpate.ExactBelief(network).probabilities("category", "material")

    def given(name: str) -> np.ndarray:
        sensor = network.actions[name].sensor
        assert isinstance(sensor, ConfusionSensor)
        on_category = sensor.property == "category"
        return sensor.table[:, :, None] if on_category else sensor.table[:, None, :]

    def information(pair: tuple[str, str]) -> float:
        joint = prior * given(pair[0])[:, None] * given(pair[1])[None]
        outcome = joint.sum(axis=(2, 3))
        return entropy_bits(outcome) + entropy_bits(prior) - entropy_bits(joint)

    best = max(combinations(names, 2), key=information)
    assert set(best_sets(network, Learn("category", "material"), names)[2]) == set(best)


def test_names_of_methods_are_their_own() -> None:
    """No two methods have a name, and smaller collections are parts of the whole."""
    names = [method.name for method in all_methods()]
    assert len(set(names)) == len(names)
    assert {method.name for method in (*few_methods(), *methods_on_costs())} <= set(names)


def test_beliefs_without_evidence_are_shared() -> None:
    """Trials that share their priors ask for the engine's belief once."""
    (tape,) = worlds()[0].tapes(1, 0, 0, 1)
    priors: dict[Engine, Belief] = {}
    first, second = (Trial(NETWORK, tape, Learn("material"), {}, 0, priors) for _ in range(2))
    assert first.belief(EXACT, ()) is second.belief(EXACT, ())
    after = palpate.ExactBelief(NETWORK).update("mat-sound", tape.outcomes["mat-sound"])
    expected = Learn("material").gains(after, first.left(("mat-sound",)))
    assert first.gains(EXACT, ("mat-sound",)) == pytest.approx(expected)
