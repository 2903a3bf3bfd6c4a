"""Explorations of tapes are those of `palpate.explore`, worked out once for all of them."""

import numpy as np
import pytest

from palpate import (
    ExactBelief,
    FunctionRobot,
    GainBelow,
    Greedy,
    Learn,
    Network,
    NothingLeft,
    Random,
    Weighted,
    explore,
)
from palpate.experiments.branches import Branches
from palpate.experiments.engines import PRESETS, Exact, MessagePassing, engine_words
from palpate.experiments.reproduction.arms import Arm
from palpate.experiments.reproduction.episodes import Goal, episode
from palpate.experiments.tapes import TapeRobot, draw_tapes
from palpate.inference.message_passing import MessagePassingBelief, Settings
from palpate.selection.stopping import NetGainBelow

GOALS = [Goal("category", ("category",)), Goal("both", ("category", "material")), Goal("elasticity", ("elasticity",))]


@pytest.fixture(scope="module")
def tape(household: Network):
    return draw_tapes(household, ["wineglass_ycb"], 1, seed=5)[0]


@pytest.mark.parametrize("goal", GOALS, ids=lambda goal: goal.name)
def test_with_and_without_stopping_are_one_exploration(household: Network, tape, goal: Goal) -> None:
    """Up to where the rule stops it is the exploration with the rule, to its end the one without."""
    arm = Arm("greedy", Exact(), Greedy(), GainBelow(0.05))
    points = list(episode(Branches(household, Exact(), tape, 0), arm, goal, np.random.default_rng(0)))
    objective = Weighted({Learn(name): 1.0 for name in goal.properties})
    for stopping, taken in (
        (NothingLeft(), points[-1].taken),
        (GainBelow(0.05), next(point.taken for point in points if point.stop)),
    ):
        steps = list(explore(ExactBelief(household), TapeRobot(tape), objective=objective, stopping=stopping))
        assert tuple(step.action for step in steps[:-1]) == taken
        for step, point in zip(steps, points, strict=False):
            assert point.gains_bits == pytest.approx(step.gains_bits, abs=1e-9)
    assert [point.stopped for point in points] == sorted(point.stopped for point in points)
    assert sum(point.stop is not None for point in points) == 1


def test_message_passing_is_followed_in_the_order_taken(household: Network, tape) -> None:
    """Where the order of evidence matters, beliefs are those of the actions in their order."""
    engine = MessagePassing(Settings.as_released())
    arm = Arm("greedy", engine, Greedy(), NetGainBelow(0.0))
    branches = Branches(household, engine, tape, 3)
    points = list(episode(branches, arm, GOALS[1], np.random.default_rng(0)))
    belief = MessagePassingBelief(household, Settings.as_released(), 3)
    steps = list(explore(belief, TapeRobot(tape), objective=Learn("category", "material"), stopping=NetGainBelow(0.0)))
    stopped = next(point for point in points if point.stop)
    assert tuple(step.action for step in steps[:-1]) == stopped.taken
    found = branches.belief(stopped.taken).probabilities("material")
    assert found.tolist() == steps[-1].after.probabilities("material").tolist()


def test_exact_beliefs_do_not_depend_on_the_order(household: Network, tape) -> None:
    """The belief after the same actions is one and the same object, and that of updates one by one."""
    branches = Branches(household, Exact(), tape, 0)
    one, other = (branches.belief(order) for order in (("weighing", "mat-sound"), ("mat-sound", "weighing")))
    assert one is other
    direct = ExactBelief(household)
    for action in ("weighing", "mat-sound"):
        direct = direct.update(action, tape.outcomes[action])
    assert one.probabilities("category") == pytest.approx(direct.probabilities("category"), abs=1e-12)
    gains = [branches.realised(order, "material") for order in (("weighing", "mat-sound"), ("mat-sound", "weighing"))]
    assert gains[0] != gains[1]


def test_random_choices_are_those_of_the_generator(household: Network, tape) -> None:
    """The same generator gives the same order, whatever is to be learned."""
    arm = Arm("random", Exact(), Random(), NothingLeft())
    branches = Branches(household, Exact(), tape, 0)
    orders = {list(episode(branches, arm, goal, np.random.default_rng(9)))[-1].taken for goal in GOALS}
    assert len(orders) == 1


def test_actions_that_are_not_on_the_tape_are_not_taken(household: Network, tape) -> None:
    """A tape with gaps ends where its actions end."""
    robot = FunctionRobot({"weighing": lambda: tape.outcomes["weighing"]})
    short = type(tape)(tape.object, 0, {name: robot.perform(name) for name in robot.actions()}, tape.truth)
    points = list(episode(Branches(household, Exact(), short, 0), Arm("g", Exact(), Greedy(), NothingLeft()), GOALS[0],
                          np.random.default_rng(0)))  # fmt: skip
    assert [point.taken for point in points] == [(), ("weighing",)]


@pytest.mark.parametrize("name", PRESETS)
def test_presets_have_names(name: str) -> None:
    """An engine of a preset goes by its name, and people read it without hyphens."""
    assert MessagePassing(PRESETS[name]).name == name
    assert engine_words(name).startswith("ACTSEL ")
