"""Look-ahead against enumeration of all outcomes, written here anew."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.errors import EvidenceError
from palpate.explore import explore
from palpate.inference.exact import ExactBelief
from palpate.network.families import Normal
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Label, Reading
from palpate.robots.sampled import SampledRobot
from palpate.selection.foresight import Tabled, Walked, foresight
from palpate.selection.lookahead import LookAhead
from palpate.selection.objectives import Everything, Learn, Objective, Weighted
from palpate.selection.policies import Choice, Greedy
from palpate.selection.purse import Purse
from palpate.selection.stopping import NothingLeft

KIND, STUFF = np.array([0.5, 0.3, 0.2]), np.array([[0.8, 0.2], [0.4, 0.6], [0.1, 0.9]])
TABLES = {
    "look": ("kind", np.array([[0.7, 0.2, 0.1], [0.2, 0.6, 0.1], [0.1, 0.2, 0.8]])),
    "glance": ("kind", np.array([[0.6, 0.3, 0.3], [0.4, 0.7, 0.7]])),
    "knock": ("stuff", np.array([[0.8, 0.1], [0.1, 0.2], [0.1, 0.7]])),
    "lick": ("stuff", np.array([[0.9, 0.4], [0.1, 0.6]])),
}


def toy(rho: Mapping[str, float] | None = None, tables: Any = None) -> Network:
    """Two categorical properties and actions that return labels."""
    properties = {
        "kind": CategoricalProperty("kind", ("a", "b", "c"), (), KIND),
        "stuff": CategoricalProperty("stuff", ("x", "y"), ("kind",), STUFF),
    }
    actions = {}
    for name, (measured, table) in (tables or TABLES).items():
        labels = tuple(f"{name}{i}" for i in range(len(table)))
        sensor = ConfusionSensor(measured, labels, table, (rho or {}).get(name, 0.0))
        actions[name] = Action(name, 1.0, sensor)
    return Network("toy", properties, actions)


# -- the oracle: p(objective state, outcomes) of sequences of actions, one outcome at a time ---------


def given_state(rho: Mapping[str, float], tables: Any, seen: Sequence[tuple[str, int]]) -> Any:
    """p(labels of a sequence | kind, stuff), hidden labels summed out (3, 2)."""
    out = np.ones((3, 2))
    for action, (measured, table) in tables.items():
        labels = [label for name, label in seen if name == action]
        share, total = rho.get(action, 0.0), np.zeros(table.shape[1])
        for hidden, p_hidden in enumerate(table):
            term = p_hidden.copy()
            for label in labels:
                term = term * (share * (hidden == label) + (1 - share) * table[label])
            total = total + term
        out = out * (total[:, None] if measured == "kind" else total[None, :])
    return out


def information(joints: Sequence[Any]) -> float:
    """I(Z; Y) [bits] from a vector p(z, y) for each y."""
    table = np.array(joints)
    safe = np.where(table > 0, table, 1.0)
    independent = table.sum(axis=0)[None, :] * table.sum(axis=1)[:, None] / table.sum()
    return float((table * np.log2(safe / np.where(table > 0, independent, 1.0))).sum())


class Enumeration:
    """Values of plans by going through every outcome."""

    def __init__(self, objective: str, repeat: bool, rho: Mapping[str, float] | None = None, tables: Any = None):
        self.axis, self.repeat = {"kind": (1,), "stuff": (0,), "both": ()}[objective], repeat
        self.rho, self.tables = rho or {}, tables or TABLES

    def mass(self, seen: Sequence[tuple[str, int]]) -> Any:
        """p(objective's state, outcomes seen)."""
        joint = KIND[:, None] * STUFF * given_state(self.rho, self.tables, seen)
        return joint.sum(axis=self.axis).ravel()

    def after(self, seen: tuple[tuple[str, int], ...], action: str, depth: int) -> float:
        """Value of an action and the best after it, times the probability of what was seen."""
        results = [(*seen, (action, label)) for label in range(len(self.tables[action][1]))]
        value = information([self.mass(result) for result in results])
        left = [a for a in self.tables if self.repeat or a not in {name for name, _ in results[0]}]
        if depth > 1 and left:
            value += sum(max(self.after(result, a, depth - 1) for a in left) for result in results)
        return value

    def together(self, actions: Sequence[str]) -> float:
        """Information of a fixed set."""
        labels = product(*(range(len(self.tables[a][1])) for a in actions))
        return information([self.mass(list(zip(actions, y, strict=True))) for y in labels])


OBJECTIVES: dict[str, Objective] = {"kind": Learn("kind"), "stuff": Learn("stuff"), "both": Learn("stuff", "kind")}


def choice(
    belief: Any, objective: Objective, actions: Sequence[str] | None = None, repeat: bool = False, **rest: Any
) -> Choice:
    gains = objective.gains(belief, actions or list(belief.network.actions))
    costs = {name: action.cost_s for name, action in belief.network.actions.items()}
    return Choice(belief, objective, gains, costs, np.random.default_rng(0), (), repeat, **rest)


@pytest.mark.parametrize("depth", [1, 2, 3, 4, 9])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_values_are_those_of_enumeration(objective: str, depth: int) -> None:
    """The value of each first action is the expectation over all outcomes of the best adaptive choices."""
    oracle, belief = Enumeration(objective, repeat=False), ExactBelief(toy())
    plans = foresight(belief, OBJECTIVES[objective], tuple(TABLES), repeat=False)
    assert isinstance(plans, Tabled)
    walked = Walked(belief, OBJECTIVES[objective], tuple(TABLES), False)
    values = {action: oracle.after((), action, depth) for action in TABLES}
    for action, value in values.items():
        assert plans.best(action, depth) == pytest.approx(value, abs=1e-10)
        if depth < 3:
            assert walked.best(action, depth) == pytest.approx(value, abs=1e-10)
    chosen = LookAhead(depth).choose(choice(belief, OBJECTIVES[objective]))
    assert values[chosen] == pytest.approx(max(values.values()), abs=1e-10)


RHO = {"look": 0.6, "knock": 0.9}


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_repetitions_that_share_a_hidden_label_are_those_of_enumeration(objective: str) -> None:
    """With repeats, what is left to be told by a sensor that repeats itself is counted."""
    tables = {name: TABLES[name] for name in RHO}
    oracle, belief = Enumeration(objective, True, RHO, tables), ExactBelief(toy(RHO, tables))
    plans = foresight(belief, OBJECTIVES[objective], tuple(tables), repeat=True)
    assert isinstance(plans, Walked)
    values = {action: oracle.after((), action, 3) for action in tables}
    for action in tables:
        assert plans.best(action, 3) == pytest.approx(values[action], abs=1e-10)
        assert plans.together([action, action]) == pytest.approx(
            information([oracle.mass([(action, y), (action, z)]) for y, z in product(range(3), repeat=2)]), abs=1e-10
        )
    chosen = LookAhead(3).choose(choice(belief, OBJECTIVES[objective], repeat=True))
    assert values[chosen] == pytest.approx(max(values.values()), abs=1e-10)


def test_evidence_so_far_counts() -> None:
    """After labels of a sensor that repeats itself, plans are made for what is left of it."""
    belief = ExactBelief(toy(RHO)).update("look", Label("look1")).update("glance", Label("glance0"))
    seen = (("look", 1), ("glance", 0))
    oracle = Enumeration("both", False, RHO)
    actions = ("look", "knock", "lick")  # the look again, once
    plans = foresight(belief, Learn("kind", "stuff"), actions, repeat=False)
    assert isinstance(plans, Tabled)
    share = oracle.mass(seen).sum()
    for first in actions:
        value = information([oracle.mass((*seen, (first, y))) for y in range(len(TABLES[first][1]))])
        for y in range(len(TABLES[first][1])):
            options = [
                information([oracle.mass((*seen, (first, y), (a, z))) for z in range(len(TABLES[a][1]))])
                for a in actions
                if a != first
            ]
            value += max(options)
        assert plans.best(first, 2) == pytest.approx(value / share, abs=1e-10)


columns = st.lists(st.floats(0.05, 1.0), min_size=3, max_size=3).map(lambda w: np.array(w) / sum(w))
matrices = st.lists(columns, min_size=3, max_size=3).map(lambda c: np.array(c).T)
pairs = st.lists(columns, min_size=2, max_size=2).map(lambda c: np.array(c).T)


@given(matrices, matrices, pairs, st.sampled_from(sorted(OBJECTIVES)))
@settings(max_examples=15, deadline=None)
def test_any_tables(look: Any, glance: Any, knock: Any, objective: str) -> None:
    """For any sensors values are those of enumeration, and grow with the depth up to all actions together."""
    tables = {"look": ("kind", look), "glance": ("kind", glance), "knock": ("stuff", knock)}
    plans = Tabled(ExactBelief(toy(None, tables)), OBJECTIVES[objective], tables)
    oracle = Enumeration(objective, False, None, tables)
    for action in tables:
        values = [plans.best(action, depth) for depth in (1, 2, 3, 4)]
        assert values[1] == pytest.approx(oracle.after((), action, 2), abs=1e-9)
        assert (np.diff(values) >= -1e-12).all()
        assert values[2] == pytest.approx(plans.together(list(tables)), abs=1e-9)


def hidden_pair() -> Network:
    """A parity of two coins that no single look can tell; and a faint hint beside it."""
    coin = np.array([0.5, 0.5])
    parity = np.array([[[1.0, 0.0], [0.0, 1.0]], [[0.0, 1.0], [1.0, 0.0]]])
    properties = {
        "left": CategoricalProperty("left", ("head", "tail"), (), coin),
        "right": CategoricalProperty("right", ("head", "tail"), (), coin),
        "parity": CategoricalProperty("parity", ("even", "odd"), ("left", "right"), parity),
    }
    clear, faint = np.eye(2), np.array([[0.6, 0.4], [0.4, 0.6]])
    sensors = {"hint": ("parity", faint), "see-left": ("left", clear), "see-right": ("right", clear)}
    actions = {n: Action(n, 1.0, ConfusionSensor(p, ("h", "t"), table)) for n, (p, table) in sensors.items()}
    return Network("coins", properties, actions)


def test_looking_ahead_sees_what_greedy_does_not() -> None:
    """Two looks that tell nothing alone and all together are found at depth 2."""
    belief = ExactBelief(hidden_pair())
    assert Greedy().choose(choice(belief, Learn("parity"))) == "hint"
    assert LookAhead(2).choose(choice(belief, Learn("parity"))) == "see-left"
    plans = foresight(belief, Learn("parity"), tuple(belief.network.actions), repeat=False)
    assert plans.best("see-left", 2) == pytest.approx(1.0, abs=1e-12)
    assert plans.best("see-left", 1) == pytest.approx(0.0, abs=1e-12)


@cache
def household() -> ExactBelief:
    return ExactBelief(load_network("household-filled"))


GREEDY: dict[str, Callable[[], tuple[ExactBelief, Objective]]] = {
    "prior": lambda: (household(), Learn("material")),
    "two": lambda: (household(), Learn("category", "material")),
    "everything": lambda: (household(), Everything()),
    "continuous": lambda: (household(), Learn("mass")),
    "weighted": lambda: (household(), Weighted({Learn("material"): 1.0, Learn("mass"): 0.5})),
    "evidence": lambda: (household().update("cat-vision", Label("mug")).update("squeezing", Above(95.0)), Everything()),
}


@pytest.mark.parametrize("case", GREEDY.values(), ids=GREEDY.keys())
def test_depth_one_is_greedy(case: Callable[[], tuple[ExactBelief, Objective]]) -> None:
    """Looking one action ahead chooses as greedy does, and its values are the expected gains."""
    belief, objective = case()
    asked = choice(belief, objective)
    assert LookAhead(1).choose(asked) == Greedy().choose(asked)
    plans = foresight(belief, objective, asked.actions, repeat=False)
    assert {a: plans.best(a, 1) for a in asked.actions} == pytest.approx(dict(asked.gains), abs=1e-9)


@pytest.mark.parametrize("evidence", [[], [("cat-vision", Label("mug")), ("squeezing", Reading(40.0))]])
def test_tables_and_walks_agree_on_numbers(evidence: list[Any]) -> None:
    """Values over readings are the same, to 1e-4 bits, from one table of outcomes and belief by belief."""
    belief = household()
    for action, outcome in evidence:
        belief = belief.update(action, outcome)
    actions = tuple(a for a in belief.network.actions if a not in {name for name, _ in evidence})
    tabled = foresight(belief, Learn("material"), actions, repeat=False)
    assert isinstance(tabled, Tabled)
    walked = Walked(belief, Learn("material"), actions, False)
    for action in actions:
        assert tabled.best(action, 2) == pytest.approx(walked.best(action, 2), abs=1e-4)
    pair = ("mat-sound", "weighing")
    assert tabled.together(pair) == pytest.approx(walked.together(pair), abs=1e-4)
    assert walked.together(pair) == pytest.approx(walked.together(pair[::-1]), abs=1e-4)


def test_a_continuous_objective_of_two_readings_has_its_closed_form() -> None:
    """Two readings of a normal property tell 0.5 log2(1 + s^2 (1/n1^2 + 1/n2^2)) together, whichever is first."""
    one = np.array(1.0)
    length = ContinuousProperty("length", "m", (), Normal(0 * one, 2 * one, -np.inf * one, np.inf * one))
    sensors = {"rule": NumberSensor("length", 1.0), "laser": NumberSensor("length", 0.5)}
    network = Network("rod", {"length": length}, {n: Action(n, 1.0, s) for n, s in sensors.items()})
    plans = foresight(ExactBelief(network), Learn("length"), ("rule", "laser"), repeat=False)
    assert isinstance(plans, Walked)
    expected = 0.5 * np.log2(1 + 4 * (1 + 4))
    assert [plans.best(a, 2) for a in sensors] == pytest.approx([expected, expected], abs=2e-3)
    assert plans.together(["laser", "rule"]) == pytest.approx(expected, abs=2e-3)
    again = foresight(ExactBelief(network), Learn("length"), ("rule", "laser"), repeat=True)
    assert again.best("laser", 2) == pytest.approx(0.5 * np.log2(1 + 4 * 8), abs=2e-3)


@pytest.mark.parametrize("rest", [{"steps_left": 1}, {"left_s": 1.5}])
def test_plans_keep_to_what_is_left(rest: dict[str, Any]) -> None:
    """With one step left, or the cost of one, looking further ahead is greedy; with two it is not."""
    belief = ExactBelief(hidden_pair())
    assert LookAhead(5).choose(choice(belief, Learn("parity"), **rest)) == "hint"
    more = {name: value + 1 for name, value in rest.items()}
    assert LookAhead(5).choose(choice(belief, Learn("parity"), **more)) == "see-left"


PURSE = Purse(4.0, {"look": 3.0, "glance": 2.0, "knock": 2.0, "lick": 1.0})


class Thrifty(Enumeration):
    """Values of plans that cost no more than the purse holds."""

    def after(self, seen: tuple[tuple[str, int], ...], action: str, depth: int) -> float:
        results = [(*seen, (action, label)) for label in range(len(self.tables[action][1]))]
        value = information([self.mass(result) for result in results])
        done = [name for name, _ in results[0]]
        left = [a for a in self.tables if a not in done or self.repeat]
        left = [a for a in left if sum(PURSE.costs_s[name] for name in (*done, a)) <= 4.0]
        if depth > 1 and left:
            value += sum(max(self.after(result, a, depth - 1) for a in left) for result in results)
        return value


@pytest.mark.parametrize("repeat", [False, True])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_values_within_a_budget_are_those_of_enumeration(objective: str, repeat: bool) -> None:
    """Only plans that the rest of the budget pays for count, with and without repetition."""
    oracle, belief = Thrifty(objective, repeat), ExactBelief(toy())
    plans = foresight(belief, OBJECTIVES[objective], tuple(TABLES), repeat, PURSE)
    walked = Walked(belief, OBJECTIVES[objective], tuple(TABLES), repeat, PURSE)
    for action in TABLES:
        for depth in (2, 3):
            value = oracle.after((), action, depth)
            assert plans.best(action, depth) == pytest.approx(value, abs=1e-10)
            assert walked.best(action, depth) == pytest.approx(value, abs=1e-10)


def test_looking_ahead_tells_how_far_it_is() -> None:
    """Each first action is told before it is looked at, with how many there are; it is no part of the policy."""
    told: list[Any] = []
    policy = LookAhead(2, told=lambda done, of: told.append((done, of)))
    policy.choose(choice(ExactBelief(toy()), Learn("kind")))
    assert told == [(0, 4), (1, 4), (2, 4), (3, 4)]
    assert policy == LookAhead(2)
    assert repr(policy) == "LookAhead(depth=2)"


MIXED: dict[str, Objective] = {
    "everything": Everything(),
    "weighted": Weighted({Learn("stuff"): 2.0, Learn("kind"): 0.5, Everything(): 0.25}),
    "two": Weighted({Learn("kind"): 2.0, Learn("stuff", "kind"): 1.0}),
}


@pytest.mark.parametrize("objective", MIXED.values(), ids=MIXED.keys())
def test_sums_and_everything_are_tabled(objective: Objective) -> None:
    """Everything and weighted sums of labels' objectives have one table, which agrees with walking, evidence or not."""
    belief = ExactBelief(toy(RHO))
    for before in (belief, belief.update("look", Label("look1"))):
        plans = foresight(before, objective, tuple(TABLES), repeat=False)
        assert isinstance(plans, Tabled)
        walked = Walked(before, objective, tuple(TABLES), False)
        for action in TABLES:
            for depth in (1, 2, 3):
                assert plans.best(action, depth) == pytest.approx(walked.best(action, depth), abs=1e-10)
        assert plans.together(list(TABLES)) == pytest.approx(walked.together(list(TABLES)), abs=1e-10)


def test_everything_in_labels_is_the_joint_of_all_states() -> None:
    """In a network of categorical properties everything is all of them together."""
    belief, oracle = ExactBelief(toy()), Enumeration("both", False)
    plans = foresight(belief, Everything(), tuple(TABLES), repeat=False)
    assert [plans.best(a, 3) for a in TABLES] == pytest.approx([oracle.after((), a, 3) for a in TABLES], abs=1e-10)


@pytest.mark.parametrize("case", ["prior", "evidence"])
@pytest.mark.parametrize("objective", [Everything(), Weighted({Everything(): 0.5, Learn("material"): 1.0})], ids=repr)
def test_tables_and_walks_agree_on_everything(case: str, objective: Objective) -> None:
    """Values about everything, saturating readings included, are the same to 1e-5 bits as belief by belief."""
    belief = household()
    if case == "evidence":
        belief = belief.update("cat-vision", Label("mug")).update("squeezing", Reading(60.0))
    actions = tuple(belief.network.actions)
    tabled = foresight(belief, objective, actions, repeat=False)
    assert isinstance(tabled, Tabled)
    walked = Walked(belief, objective, actions, False)
    for action in actions:
        assert tabled.best(action, 2) == pytest.approx(walked.best(action, 2), abs=1e-5)


@pytest.mark.parametrize("depth", [0, -1])
def test_a_depth_that_is_none_is_refused(depth: int) -> None:
    """A look-ahead looks at least one action ahead."""
    with pytest.raises(EvidenceError, match=f"depth {depth} was asked for, expected at least 1"):
        LookAhead(depth)


def test_too_much_ahead_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plan whose table would not fit into memory is refused, with what to do about it."""
    monkeypatch.setattr("palpate.selection.tabled.MAX_ENTRIES", 30)
    plans = Tabled(ExactBelief(toy()), Learn("kind"), TABLES)
    with pytest.raises(EvidenceError, match=r"looking ahead over look, .* look less far ahead"):
        plans.best("look", 3)


def test_tables_that_would_not_fit_are_not_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where even the tables of single outcomes would not fit into memory, plans are walked."""
    monkeypatch.setattr("palpate.selection.tabled.MAX_ENTRIES", 6 * (3 + 2 + 3 + 2))
    assert isinstance(foresight(ExactBelief(toy()), Everything(), tuple(TABLES), repeat=False), Tabled)
    monkeypatch.setattr("palpate.selection.tabled.MAX_ENTRIES", 6 * (3 + 2 + 3 + 2) - 1)
    assert isinstance(foresight(ExactBelief(toy()), Everything(), tuple(TABLES), repeat=False), Walked)


def test_other_engines_cannot_look_ahead() -> None:
    """An engine without probabilities of outcomes cannot look ahead, and the error says so."""
    belief: Any = SimpleNamespace(network=toy())
    with pytest.raises(EvidenceError, match="needs the exact engine, found SimpleNamespace"):
        foresight(belief, Learn("kind"), ("look",), repeat=False)


def test_looking_ahead_explores() -> None:
    """As a policy it takes every action of an exploration once when nothing stops it."""
    robot = SampledRobot(household().network, "ceramic_mug", np.random.default_rng(1))
    steps = list(explore(household(), robot, objective=Learn("material"), policy=LookAhead(3), stopping=NothingLeft()))
    assert sorted(str(s.action) for s in steps[:-1]) == sorted(household().network.actions)
