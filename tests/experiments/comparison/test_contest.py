"""Methods on the same tapes, against orders walked one by one."""

import pickle
from itertools import permutations

import numpy as np
import pytest
from numpy.typing import NDArray

import palpate
from palpate.experiments.comparison.contest import ContestTask, objective_of
from palpate.experiments.comparison.methods import EXACT, RANDOM, RELEASED, ByPolicy, Method, StaticSets, few_methods
from palpate.experiments.comparison.worlds import worlds
from palpate.experiments.running import Row
from palpate.selection.policies import Greedy

GREEDY, ACTSEL, _, CHOICES = few_methods()[:4]
STATIC = Method("static", "", StaticSets(), EXACT)


def task(*methods: Method, stop: int = 2) -> ContestTask:
    return ContestTask(worlds()[0], methods, 4, 0, stop, 1, seed=5)


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return task(GREEDY, RANDOM, STATIC).run()


def numbers(rows: list[Row], column: str) -> NDArray[np.float64]:
    return np.array([row[column] for row in rows], float)


def of(rows: list[Row], method: str) -> list[Row]:
    return [row for row in rows if row["method"] == method and row["object"] == "drawn-00000"]


def test_random_is_the_mean_over_all_orders(rows: list[Row]) -> None:
    """The weighted score at each step is the mean over the 120 orders, each updated outcome by outcome."""
    world = worlds()[0]
    (tape,) = world.tapes(4, 5, 0, 1)
    network = palpate.load_network("household-filled")
    place = network.categorical[0].states.index(str(tape.truth["category"]))
    seen: dict[frozenset[str], float] = {}

    def bits(order: tuple[str, ...]) -> float:
        if frozenset(order) not in seen:
            belief = palpate.ExactBelief(network)
            for action in order:
                belief = belief.update(action, tape.outcomes[action])
            seen[frozenset(order)] = -np.log2(belief.probabilities("category")[place])
        return seen[frozenset(order)]

    for step in range(6):
        expected = np.mean([bits(order[:step]) for order in permutations(network.actions)])
        own = [row for row in of(rows, RANDOM.name) if row["step"] == step]
        found = np.dot(numbers(own, "weight"), numbers(own, "category_cross_entropy_bits"))
        assert found == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("method", [GREEDY, RANDOM, STATIC], ids=lambda method: method.name)
def test_weights_sum_to_one_at_each_step(rows: list[Row], method: Method) -> None:
    """Each step's beliefs of an object are a distribution."""
    for step in range(6):
        weights = numbers([row for row in of(rows, method.name) if row["step"] == step], "weight")
        assert weights.sum() == pytest.approx(1)


def test_expected_gains_are_of_the_action_taken(rows: list[Row]) -> None:
    """Before any evidence greedy expects the largest gain of all, and that is what is left to be had."""
    network = palpate.load_network("household-filled")
    gains = palpate.ExactBelief(network).expected_gains([("category", "material")])
    best = max(row["category", "material"] or 0.0 for row in gains.values())
    start, first, *_, last = of(rows, GREEDY.name)
    assert start["best_gain_bits"] == pytest.approx(best)
    assert first["expected_gain_bits"] == first["information_bits"] == pytest.approx(best)
    assert last["best_gain_bits"] is None


def test_choices_and_beliefs_are_told_apart() -> None:
    """ACTSEL's choices with exact beliefs: its actions, and the scores of exact beliefs."""
    found = task(ACTSEL, CHOICES, RANDOM, stop=1).run()
    used = [[row["used"] for row in found if row["method"] == method.name] for method in (ACTSEL, CHOICES)]
    assert used[0] == used[1]
    exact = {row["used"]: row["material_brier"] for row in found if row["method"] == RANDOM.name}
    network = worlds()[0].believed
    for row in (row for row in found if row["method"] == CHOICES.name):
        taken = str(row["used"]).split("+") if row["used"] else []
        key = "+".join(sorted(taken, key=list(network.actions).index))
        assert row["material_brier"] == exact[key]


def test_a_task_gives_the_same_in_another_process() -> None:
    """A pickled task gives the same rows to the last bit, message passing included."""
    own = task(Method("actsel", "", ByPolicy(RELEASED, Greedy()), RELEASED), stop=1)
    assert pickle.loads(pickle.dumps(own)).run() == own.run()


def test_the_objective_is_all_categorical_properties() -> None:
    """Of the household network: category and material together."""
    assert objective_of(palpate.load_network("household")).properties == ("category", "material")
