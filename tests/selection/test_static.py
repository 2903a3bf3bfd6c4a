"""The best static set against all sets, enumerated here."""

from collections.abc import Sequence
from functools import cache, partial
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.errors import EvidenceError
from palpate.explore import explore
from palpate.inference.exact import ExactBelief
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Failed, Label, Reading
from palpate.robots.protocol import FunctionRobot
from palpate.robots.sampled import SampledRobot
from palpate.selection.foresight import Tabled, Walked, foresight
from palpate.selection.objectives import Everything, Learn, Objective
from palpate.selection.policies import Choice
from palpate.selection.static import StaticSet
from palpate.selection.stopping import NothingLeft, StepBudget

PRIOR = np.array([0.4, 0.3, 0.2, 0.1])


def isolating(state: int) -> Any:
    """A sharp test of one state, outcomes x states."""
    hit = np.where(np.arange(4) == state, 0.95, 0.05)
    return np.stack([hit, 1 - hit])


HALVES = np.array([[0.99, 0.99, 0.01, 0.01], [0.01, 0.01, 0.99, 0.99]])
TABLES = {
    "first": isolating(0),
    "again": isolating(0),
    "halves": HALVES,
    "alternate": HALVES[:, [0, 2, 1, 3]],
    "dull": np.full((3, 4), 1 / 3),
}


def toy(tables: Any = None, rho: float = 0.0) -> ExactBelief:
    actions = {
        name: Action(name, 1.0, ConfusionSensor("kind", tuple(map(str, range(len(t)))), t, rho))
        for name, t in (tables or TABLES).items()
    }
    return ExactBelief(Network("toy", {"kind": CategoricalProperty("kind", tuple("abcd"), (), PRIOR)}, actions))


def entropy(p: Any) -> float:
    held = np.ravel(p)[np.ravel(p) > 0]
    return float(-(held * np.log2(held)).sum())


def set_information(actions: Sequence[str], tables: Any = None) -> float:
    """H(kind) + H(labels) - H(kind, labels), one combination of labels at a time."""
    known = tables or TABLES
    rows = [
        PRIOR * np.prod([known[a][y] for a, y in zip(actions, labels, strict=True)], axis=0)
        for labels in product(*(range(len(known[a])) for a in actions))
    ]
    joint = np.array(rows)
    return entropy(PRIOR) + entropy(joint.sum(axis=1)) - entropy(joint)


def choice(belief: ExactBelief, taken: Sequence[str] = (), objective: Objective | None = None) -> Choice:
    aim = objective or Learn("kind")
    gains = aim.gains(belief, [a for a in belief.network.actions if a not in taken])
    costs = {name: action.cost_s for name, action in belief.network.actions.items()}
    return Choice(belief, aim, gains, costs, np.random.default_rng(0), taken)


def chosen(policy: StaticSet, belief: ExactBelief, objective: Objective | None = None) -> list[str]:
    """All actions that the policy takes."""
    taken: list[str] = []
    while action := policy.choose(choice(belief, taken, objective)):
        taken.append(action)
    return taken


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5])
def test_the_set_is_the_best_of_all(size: int) -> None:
    """The set chosen tells as much as the best of all sets of its size, most telling action first."""
    best = max(combinations(TABLES, size), key=set_information)
    found = chosen(StaticSet(size), toy())
    assert set_information(found) == pytest.approx(set_information(best), abs=1e-12)
    assert len(found) == size == len(set(found))
    alone = [set_information([action]) for action in found]
    assert alone == sorted(alone, reverse=True)


def test_the_set_is_chosen_together() -> None:
    """Two halvings that complete each other are preferred to what is best alone and what repeats it."""
    assert set(chosen(StaticSet(2), toy())) == {"halves", "alternate"}


def test_a_set_larger_than_the_repertoire_is_the_repertoire() -> None:
    """Where there are fewer actions than asked for, all of them are taken."""
    assert sorted(chosen(StaticSet(50), toy())) == sorted(TABLES)


columns = st.lists(st.floats(0.02, 1.0), min_size=3, max_size=3).map(lambda w: np.array(w) / sum(w))
matrices = st.lists(columns, min_size=4, max_size=4).map(lambda c: np.array(c).T)


@given(st.lists(matrices, min_size=3, max_size=3))
@settings(max_examples=20, deadline=None)
def test_what_a_set_tells_is_bounded(given_tables: list[Any]) -> None:
    """A set tells as much as its best action, at most the sum of entropies and gains, and adaptive choices more."""
    tables = dict(zip("xyz", given_tables, strict=True))
    belief = toy(tables)
    plans = Tabled(belief, Learn("kind"), tables)
    single = {a: plans.together([a]) for a in tables}
    for size in (2, 3):
        for actions in combinations(tables, size):
            told = plans.together(actions)
            assert told == pytest.approx(set_information(actions, tables), abs=1e-9)
            assert told >= max(single[a] for a in actions) - 1e-12
            assert told <= min(entropy(PRIOR), sum(entropy(tables[a] @ PRIOR) for a in actions)) + 1e-12
            # labels are independent given the kind, so what they tell overlaps
            assert told <= sum(single[a] for a in actions) + 1e-12
        best = max(plans.together(actions) for actions in combinations(tables, size))
        assert max(plans.best(a, size) for a in tables) >= best - 1e-12


@pytest.mark.parametrize("limit", [10, 1000])
def test_large_sets_are_worked_out_piece_by_piece(monkeypatch: pytest.MonkeyPatch, limit: int) -> None:
    """What a set tells does not depend on how much of its table is worked out at once."""
    monkeypatch.setattr("palpate.selection.tabled.MAX_ENTRIES", limit)
    plans = Tabled(toy(), Learn("kind"), TABLES)
    for size in (1, 2, 3, 5):
        for actions in combinations(TABLES, size):
            assert plans.together(actions) == pytest.approx(set_information(actions), abs=1e-10)


def test_the_order_of_a_set_does_not_matter() -> None:
    """What a set tells is the same in any order, from tables and walked."""
    belief = toy()
    for plans in (Tabled(belief, Learn("kind"), TABLES), Walked(belief, Learn("kind"), tuple(TABLES), False)):
        for actions in (("first", "halves", "dull"), ("dull", "first", "halves"), ("halves", "dull", "first")):
            assert plans.together(actions) == pytest.approx(set_information(actions), abs=1e-10)


def test_a_set_is_chosen_anew_for_each_exploration() -> None:
    """One policy serves one exploration after another, each with the set of its own first belief."""
    policy, belief = StaticSet(2), toy()
    certain = belief.update("halves", Label("0")).update("halves", Label("0"))
    assert chosen(policy, belief) == chosen(policy, belief) == chosen(StaticSet(2), belief)
    assert chosen(policy, certain) == chosen(StaticSet(2), certain) != chosen(policy, belief)


def test_the_set_is_kept_whatever_the_outcomes() -> None:
    """Outcomes and failures on the way change neither the set nor its order."""
    for label in ("0", "1"):
        robot = FunctionRobot(
            {"halves": partial(Label, label), "alternate": partial(Failed, "slipped")},
            FunctionRobot({name: lambda: Label("0") for name in TABLES}),
        )
        steps = list(explore(toy(), robot, objective=Learn("kind"), policy=StaticSet(2), stopping=NothingLeft()))
        assert sorted(str(s.action) for s in steps[:-1]) == ["alternate", "halves"]
        assert steps[-1].stop == "the policy has come to its end"


@pytest.mark.parametrize("objective", [Learn("kind"), Everything()])
def test_sensors_that_repeat_a_hidden_label_with_repeats(objective: Objective) -> None:
    """Where actions may be repeated the set is still of different ones, each taken once."""
    rho, belief = 0.8, toy(rho=0.8)
    robot = FunctionRobot({name: lambda: Label("0") for name in TABLES})
    steps = list(explore(belief, robot, objective=objective, policy=StaticSet(3), stopping=StepBudget(9), repeat=True))
    taken = [str(step.action) for step in steps[:-1]]
    assert len(taken) == len(set(taken)) == 3
    best = max(combinations(TABLES, 3), key=set_information)
    assert set_information(taken) == pytest.approx(set_information(best), abs=1e-9)
    walked = foresight(belief, objective, tuple(TABLES), repeat=True)
    assert isinstance(walked, Walked)
    twice = [
        PRIOR
        * sum(
            h * (rho * (i == y) + (1 - rho) * HALVES[y]) * (rho * (i == z) + (1 - rho) * HALVES[z])
            for i, h in enumerate(HALVES)
        )
        for y, z in product(range(2), repeat=2)
    ]
    joint = np.array(twice)
    told = entropy(PRIOR) + entropy(joint.sum(axis=1)) - entropy(joint)
    assert walked.together(["halves", "halves"]) == pytest.approx(told, abs=1e-10)


@cache
def household() -> ExactBelief:
    return ExactBelief(load_network("household-filled"))


@pytest.mark.parametrize("objective", [Learn("material"), Learn("mass")])
def test_sets_of_readings_explore(objective: Objective) -> None:
    """On a network with numbers a set of two is taken and then the policy ends."""
    belief = household().update("cat-vision", Label("mug"))
    robot = SampledRobot(belief.network, "ceramic_mug", np.random.default_rng(0))
    few = FunctionRobot({a: partial(robot.perform, a) for a in ("mat-sound", "squeezing", "weighing")})
    steps = list(explore(belief, few, objective=objective, policy=StaticSet(2), stopping=NothingLeft()))
    taken = {str(step.action) for step in steps[:-1]}
    assert len(taken) == 2
    plans = foresight(belief, objective, few.actions(), repeat=False)
    assert plans.together(sorted(taken)) == pytest.approx(
        max(plans.together(pair) for pair in combinations(few.actions(), 2)), abs=1e-4
    )


def test_readings_of_one_group_are_not_taken_for_independent() -> None:
    """Two actions that weigh one mass share its spread: the set tells less than if they did not."""
    network = household().network
    weighing = network.action("weighing")
    twice = network.with_action(Action("weighing-again", 15.0, weighing.sensor))
    plans = foresight(ExactBelief(twice), Learn("category"), ("weighing", "weighing-again"), repeat=False)
    assert isinstance(plans, Walked)
    one, both = plans.together(["weighing"]), plans.together(["weighing", "weighing-again"])
    assert one <= both < 1.2 * one
    after = ExactBelief(twice).update("weighing", Reading(118.0))
    assert after.expected_gains(["category"], ["weighing-again"])["weighing-again"]["category"] == pytest.approx(
        after.expected_gains(["category"], ["weighing"])["weighing"]["category"], abs=1e-9
    )


@pytest.mark.parametrize("size", [0, -3])
def test_a_set_of_nothing_is_refused(size: int) -> None:
    """A static set has at least one action."""
    with pytest.raises(EvidenceError, match=f"a static set of {size} actions was asked for, expected at least 1"):
        StaticSet(size)
