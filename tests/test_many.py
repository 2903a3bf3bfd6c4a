from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest

from palpate.errors import EvidenceError
from palpate.explore import Step, explore
from palpate.inference.exact import ExactBelief
from palpate.many import Run, explore_many
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Label, Outcome, Reading
from palpate.robots.protocol import FunctionRobot, Robot
from palpate.robots.sampled import SampledRobot
from palpate.selection.objectives import Everything, Learn, Weighted
from palpate.selection.policies import FixedOrder, Greedy, GreedyPerCost, Random
from palpate.selection.stopping import CostBudget, EntropyBelow, GainBelow, NetGainBelow, NothingLeft, StepBudget

OBJECTS = ("ceramic_mug", "banana_ycb", "wineglass")
FRUIT = ("ripe_avocado", "old_peach", "half_water_bottle")


@cache
def prior(name: str) -> ExactBelief:
    return ExactBelief(load_network(name))


def sampled(name: str, things: Sequence[str]) -> list[Robot]:
    """Robots whose chance starts anew at each call."""
    network = prior(name).network
    return [SampledRobot(network, thing, np.random.default_rng([7, i])) for i, thing in enumerate(things)]


def one_by_one(belief: ExactBelief, robots: Sequence[Robot], seed: int, **options: Any) -> list[list[Step]]:
    rngs = np.random.default_rng(seed).spawn(len(robots))
    return [list(explore(belief, robot, rng=rng, **options)) for robot, rng in zip(robots, rngs, strict=True)]


def assert_same(run: Run, steps: Sequence[Step]) -> None:
    """A run tells what the steps of one exploration tell."""
    *taken, last = steps
    assert run.actions == [step.action for step in taken]
    assert run.stop == last.stop
    assert run.total_cost_s == last.total_cost_s
    assert len(run.beliefs) == len(run.gains_bits) == len(steps)
    for outcome, step in zip(run.outcomes, taken, strict=True):
        assert outcome == step.admitted
    for gains, step in zip(run.gains_bits, steps, strict=True):
        assert list(gains) == list(step.gains_bits)
        assert gains == pytest.approx(step.gains_bits, abs=1e-9)
    for belief, step in zip(run.beliefs, steps, strict=True):
        other = step.before
        assert isinstance(other, ExactBelief)
        assert np.abs(belief.joint.values - other.joint.values).max() < 1e-9
        assert [seen.action for seen in belief.evidence] == [seen.action for seen in other.evidence]


HOUSEHOLD = {
    "material": {"objective": Learn("material")},
    "category-and-material": {"objective": Learn("material", "category"), "stopping": NothingLeft()},
    "everything": {"stopping": StepBudget(3)},
    "weighted": {"objective": Weighted({Learn("material"): 2.0, Learn("category"): 0.5}), "stopping": StepBudget(3)},
    "per-cost": {"objective": Learn("material"), "policy": GreedyPerCost(), "stopping": NetGainBelow(0.01)},
    "random": {"objective": Learn("category"), "policy": Random(), "stopping": NothingLeft()},
    "budget": {"objective": Learn("material"), "stopping": CostBudget(25.0) | EntropyBelow("material", 0.2)},
    "fixed": {"objective": Learn("material"), "policy": FixedOrder(["weighing", "mat-vision"])},
    "costs": {"objective": Learn("material"), "policy": GreedyPerCost(), "costs_s": {"weighing": 0.0}},
}


@pytest.mark.parametrize("options", HOUSEHOLD.values(), ids=HOUSEHOLD.keys())
def test_many_explorations_are_those_one_by_one(options: dict[str, Any]) -> None:
    """Choices, outcomes, beliefs, gains, costs and reasons to stop are those of exploring one by one."""
    belief = prior("household-filled")
    alone = one_by_one(belief, sampled("household-filled", OBJECTS), 3, **options)
    runs = explore_many(belief, sampled("household-filled", OBJECTS), rng=np.random.default_rng(3), **options)
    assert len(runs) == len(alone)
    for run, steps in zip(runs, alone, strict=True):
        assert_same(run, steps)


# Once an objective is certain its gains are rounding errors, between which greedy would choose: stop before.
PANTRY = {
    "ripeness": {"objective": Learn("ripeness"), "stopping": StepBudget(3)},
    "storage": {"objective": Learn("storage", "ripeness"), "stopping": StepBudget(6)},
    "two": {"objective": Learn("kind", "storage"), "policy": Random(), "stopping": StepBudget(4)},
    "threshold": {"objective": Learn("kind"), "policy": GreedyPerCost(), "stopping": GainBelow(0.1) | StepBudget(8)},
}


@pytest.mark.parametrize("options", PANTRY.values(), ids=PANTRY.keys())
def test_repeated_actions_that_share_something_are_those_one_by_one(options: dict[str, Any]) -> None:
    """With repeats, hidden labels and shared offsets keep each exploration's gains its own."""
    belief = prior("pantry")
    alone = one_by_one(belief, sampled("pantry", FRUIT), 11, repeat=True, **options)
    runs = explore_many(belief, sampled("pantry", FRUIT), rng=np.random.default_rng(11), repeat=True, **options)
    assert max(len(run.actions) - len(set(run.actions)) for run in runs) > 0
    for run, steps in zip(runs, alone, strict=True):
        assert_same(run, steps)


def test_explorations_from_a_belief_with_evidence_are_those_one_by_one() -> None:
    """Exploring may begin from a belief that already holds evidence of each kind."""
    belief = prior("household-filled").update("cat-vision", Label("mug")).update("weighing", Reading(230.0))
    options: dict[str, Any] = {"objective": Learn("material"), "stopping": NothingLeft()}
    alone = one_by_one(belief, sampled("household-filled", OBJECTS), 5, **options)
    runs = explore_many(belief, sampled("household-filled", OBJECTS), rng=np.random.default_rng(5), **options)
    for run, steps in zip(runs, alone, strict=True):
        assert_same(run, steps)


def faulty() -> list[Robot]:
    """Robots of which one raises, one fails now and then, one can do little and one nothing."""
    network = prior("household-filled").network
    good = SampledRobot(network, "ceramic_mug", np.random.default_rng(1))

    def raises() -> Any:
        raise OSError("no contact")

    answers: Iterator[Outcome] = iter(
        [Failed("slipped"), Label("ceramic"), Failed("slipped"), Label("metal"), Label("glass")] * 3
    )
    return [
        FunctionRobot({"mat-sound": raises, "weighing": lambda: Reading(float("nan"))}, good),
        FunctionRobot({"mat-sound": lambda: next(answers), "mat-vision": lambda: Label("no such label")}),
        FunctionRobot({"mat-vision": lambda: Label("ceramic")}),
        FunctionRobot({}),
    ]


@pytest.mark.parametrize("repeat", [False, True])
def test_failing_robots_fail_as_they_do_one_by_one(repeat: bool) -> None:
    """What raises, fails or does not fit is a failed outcome that costs and teaches nothing."""
    belief = prior("household-filled")
    options: dict[str, Any] = {"objective": Learn("material"), "stopping": StepBudget(6), "repeat": repeat}
    alone = one_by_one(belief, faulty(), 2, **options)
    runs = explore_many(belief, faulty(), rng=np.random.default_rng(2), **options)
    for run, steps in zip(runs, alone, strict=True):
        assert_same(run, steps)
    failed = [outcome for run in runs for outcome in run.outcomes if isinstance(outcome, Failed)]
    assert len(failed) >= 3
    assert any("no contact" in outcome.reason for outcome in failed)
    assert (runs[3].actions, runs[3].stop, runs[3].gains_bits) == ([], "no action is left", [{}])


def test_no_robots_make_no_runs() -> None:
    """An empty list of robots gives an empty list of runs."""
    assert explore_many(prior("household"), []) == []


def test_robots_do_not_share_their_runs() -> None:
    """Each run holds its own lists, and the first belief is the one that was given."""
    belief = prior("household-filled")
    runs = explore_many(belief, sampled("household-filled", OBJECTS), stopping=StepBudget(1))
    assert all(run.beliefs[0] is belief and len(run.actions) == 1 for run in runs)
    assert len({id(run.actions) for run in runs}) == len({id(run.beliefs[1]) for run in runs}) == len(OBJECTS)


BAD: list[tuple[Callable[[], dict[str, Any]], str]] = [
    (lambda: {"objective": Learn("colour")}, "unknown property 'colour': choose from 'category'"),
    (lambda: {"objective": Learn("material", "colour")}, "unknown property 'colour'"),
    (lambda: {"costs_s": {"licking": 1.0}}, "unknown action 'licking': choose from 'cat-vision'"),
    (lambda: {"costs_s": {"weighing": -1.0}}, "cost of action 'weighing' -1.0 was found"),
]


@pytest.mark.parametrize(("options", "told"), BAD)
def test_bad_options_are_refused(options: Callable[[], dict[str, Any]], told: str) -> None:
    """Unknown properties and actions and impossible costs are refused in one sentence."""
    with pytest.raises(EvidenceError, match=told):
        explore_many(prior("household"), [FunctionRobot({"weighing": lambda: Reading(1.0)})], **options())


def test_an_unknown_action_of_a_robot_is_refused() -> None:
    """A robot that offers what the network does not know is a mistake, not a failure."""
    with pytest.raises(EvidenceError, match="unknown action 'licking'"):
        explore_many(prior("household"), [FunctionRobot({"licking": lambda: Reading(1.0)})])


def test_everything_is_the_objective_unless_another_is_given() -> None:
    """The defaults are those of `explore`: everything, greedy, stop below 0.05 bits."""
    belief = prior("household-filled")
    given: dict[str, Any] = {"objective": Everything(), "policy": Greedy(), "stopping": GainBelow(0.05)}
    (plain,) = explore_many(belief, sampled("household-filled", OBJECTS[:1]))
    (named,) = explore_many(belief, sampled("household-filled", OBJECTS[:1]), **given)
    assert (plain.actions, plain.stop) == (named.actions, named.stop)
    assert plain.gains_bits == named.gains_bits
