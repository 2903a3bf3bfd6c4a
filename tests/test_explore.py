import time
from collections.abc import Callable
from itertools import islice, pairwise
from typing import Any

import numpy as np
import pytest

from palpate.errors import EvidenceError
from palpate.explore import explore
from palpate.inference.belief import Belief
from palpate.inference.exact import ExactBelief
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.outcomes import Above, Failed, Label, Likelihood, Outcome, Reading
from palpate.robots.protocol import FunctionRobot
from palpate.robots.replay import ReplayRobot
from palpate.robots.sampled import SampledRobot
from palpate.selection.objectives import Learn, Weighted
from palpate.selection.policies import Choice, FixedOrder, Greedy, GreedyPerCost, Random
from palpate.selection.stopping import CostBudget, EntropyBelow, GainBelow, NothingLeft, StepBudget


@pytest.fixture(scope="module")
def prior() -> Any:
    return ExactBelief(load_network("household"))


def mug(**changed: Any) -> Any:
    """A robot that measures a ceramic mug the same way each time."""
    functions: dict[str, Callable[[], Outcome]] = {
        "cat-vision": lambda: Label("mug"),
        "mat-vision": lambda: Label("ceramic"),
        "mat-sound": lambda: Label("ceramic"),
        "squeezing": lambda: Above(95.0),
        "weighing": lambda: Reading(230.0),
    }
    return FunctionRobot({**functions, **changed})


def raising(error: BaseException) -> Any:
    def act() -> None:
        raise error

    return act


def test_every_action_is_taken_once_and_then_nothing_is_left(prior: ExactBelief) -> None:
    """Without repeats and thresholds each action is taken once; the last step says why it is over."""
    *steps, last = explore(prior, mug(), stopping=NothingLeft())
    assert sorted(str(step.action) for step in steps) == sorted(prior.network.actions)
    assert (last.action, last.outcome, last.stop) == (None, None, "no action is left")
    assert all(step.stop is None for step in steps)
    assert [step.index for step in (*steps, last)] == [1, 2, 3, 4, 5, 6]
    assert last.after is last.before is steps[-1].after


def test_steps_chain(prior: ExactBelief) -> None:
    """Each step starts from the belief and the cost the one before it ended with."""
    steps = list(explore(prior, mug(), stopping=NothingLeft()))
    assert steps[0].before is prior
    for one, following in pairwise(steps):
        assert following.before is one.after
        assert following.total_cost_s == one.total_cost_s + following.cost_s
    assert steps[-1].total_cost_s == sum(action.cost_s for action in prior.network.actions.values())


def test_greedy_takes_the_largest_expected_gain_of_the_objective(prior: ExactBelief) -> None:
    """The gains of a step are those of its belief for the objective, and greedy takes the largest."""
    for step in explore(prior, mug(), objective=Learn("material"), stopping=NothingLeft()):
        table = step.before.expected_gains(["material"], list(step.gains_bits))
        assert step.gains_bits == {action: pytest.approx(row["material"]) for action, row in table.items()}
        if step.action:
            assert step.expected_gain_bits == max(step.gains_bits.values()) == step.gains_bits[step.action]


def test_a_step_reports_what_the_belief_says(prior: ExactBelief) -> None:
    """Realised gain, entropy drop and surprise of a step are those of the beliefs around it."""
    step = next(explore(prior, mug(), objective=Learn("material"), policy=FixedOrder(["mat-sound"])))
    before, after = (belief.probabilities("material") for belief in (step.before, step.after))
    held = after > 0
    assert step.realised_gain_bits == pytest.approx(np.sum(after[held] * np.log2(after[held] / before[held])))
    entropies = [-np.sum(p[p > 0] * np.log2(p[p > 0])) for p in (before, after)]
    assert step.entropy_drop_bits == pytest.approx(entropies[0] - entropies[1])
    assert step.surprise == prior.surprise("mat-sound", Label("ceramic"))
    assert len(step.after.evidence) == 1


@pytest.mark.parametrize(
    ("act", "told"),
    [
        (raising(OSError("no contact")), "OSError: no contact"),
        (lambda: Failed("slipped"), "slipped"),
        (lambda: None, "NoneType was found"),
        (lambda: Label("ceramic"), "Label was found"),
        (lambda: Reading(float("nan")), "value nan was found"),
        (lambda: Reading(3.0, unit="kPa"), "weighing"),
    ],
)
def test_a_failed_action_is_recorded_and_exploration_goes_on(prior: ExactBelief, act: Any, told: str) -> None:
    """What raises, fails or does not fit is a failed step with its reason and cost, and no end."""
    steps = list(
        explore(prior, mug(weighing=act), policy=FixedOrder(["weighing", "mat-sound"]), stopping=NothingLeft())
    )
    failed, following, _last = steps
    assert isinstance(failed.outcome, Failed)
    assert told in failed.outcome.reason
    assert failed.cost_s == prior.network.action("weighing").cost_s
    assert failed.surprise is None
    assert failed.realised_gain_bits == pytest.approx(0.0)
    assert failed.after.probabilities("material") == pytest.approx(prior.probabilities("material"))
    assert following.action == "mat-sound"


def test_an_impossible_outcome_is_recorded_as_failed(prior: ExactBelief) -> None:
    """An outcome to which the network gives probability zero does not end a long episode."""
    category = prior.network.property("category")
    assert isinstance(category, CategoricalProperty)
    states = category.states
    certain = [Likelihood({state: float(state == name) for state in states}) for name in ("mug", "bowl")]
    robot = ReplayRobot([("cat-vision", outcome) for outcome in certain])
    first, second, _last = explore(
        prior, robot, repeat=True, policy=FixedOrder(["cat-vision"] * 2), stopping=NothingLeft()
    )
    assert not isinstance(first.outcome, Failed)
    assert isinstance(second.outcome, Failed)
    assert "not usable" in second.outcome.reason
    assert second.after.probabilities("category") == pytest.approx(first.after.probabilities("category"))


def test_a_slow_action_times_out(prior: ExactBelief) -> None:
    """An action that takes longer than the limit is failed; a quick one is not touched by it."""

    def weigh_slowly() -> Reading:
        time.sleep(2)
        return Reading(1.0)

    slow = mug(weighing=weigh_slowly)
    order = FixedOrder(["weighing", "mat-sound"])
    started = time.monotonic()
    first, second, _last = explore(prior, slow, policy=order, stopping=NothingLeft(), timeout_s=0.1)
    assert time.monotonic() - started < 1.5
    assert first.outcome == Failed("timed out after 0.1 s")
    assert second.outcome == Label("ceramic")


@pytest.mark.parametrize("timeout_s", [None, 5.0])
def test_an_interrupt_is_not_swallowed(prior: ExactBelief, timeout_s: float | None) -> None:
    """KeyboardInterrupt ends the exploration, with and without a time limit."""
    with pytest.raises(KeyboardInterrupt):
        list(explore(prior, mug(weighing=raising(KeyboardInterrupt())), stopping=NothingLeft(), timeout_s=timeout_s))


def test_a_fault_of_the_engine_is_not_swallowed(prior: ExactBelief) -> None:
    """Only the robot may fail: an error inside the library comes out."""

    class Faulty(Learn):
        def realised(self, before: Belief, after: Belief) -> float | None:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        list(explore(prior, mug(), objective=Faulty("material")))


def test_the_cost_budget_is_never_exceeded(prior: ExactBelief) -> None:
    """What does not fit into the budget is not chosen; what fits still is, to the last second."""
    *steps, last = explore(prior, mug(), stopping=CostBudget(22.0))
    assert last.total_cost_s <= 22.0
    left = set(prior.network.actions) - {step.action for step in steps}
    assert all(prior.network.action(name).cost_s > 22.0 - last.total_cost_s for name in left)
    assert "the cost budget is used up" in str(last.stop)
    assert last.gains_bits == {}


def test_a_budget_that_is_met_exactly_is_spent(prior: ExactBelief) -> None:
    """Rounding of a sum of costs does not keep the last action from being taken."""
    costs = dict.fromkeys(prior.network.actions, 0.1)
    *steps, _last = explore(prior, mug(), stopping=CostBudget(0.3), costs_s=costs)
    assert len(steps) == 3


def test_stopping_rules_end_it_with_the_gains_of_what_is_left(prior: ExactBelief) -> None:
    """The last step holds the reason and the gains of the actions that were not taken."""
    *steps, last = explore(prior, mug(), stopping=StepBudget(2) | GainBelow(1e-9))
    assert len(steps) == 2
    assert last.stop == "the budget of 2 steps is used up"
    assert set(last.gains_bits) == set(prior.network.actions) - {step.action for step in steps}
    reached = list(explore(prior, mug(), stopping=EntropyBelow("category", 10.0)))
    assert len(reached) == 1


def test_by_default_it_stops_below_a_twentieth_of_a_bit(prior: ExactBelief) -> None:
    """The default rule stops when the best expected gain is below 0.05 bits."""
    last = list(explore(prior, mug(), repeat=True, objective=Learn("category")))[-1]
    assert max(last.gains_bits.values()) < 0.05
    assert "0.05" in str(last.stop)


def test_repeats_are_allowed_only_where_asked_for(prior: ExactBelief) -> None:
    """With repeats an action may come again; without it does not."""
    order = FixedOrder(["weighing", "weighing"])
    assert len(list(explore(prior, mug(), policy=order, stopping=NothingLeft()))) == 2
    assert len(list(explore(prior, mug(), policy=order, stopping=NothingLeft(), repeat=True))) == 3


def test_an_action_that_always_fails_does_not_go_on_for_ever(prior: ExactBelief) -> None:
    """With repeats a failed action waits until another one told something, so that it ends."""
    broken = mug(weighing=raising(OSError("unplugged")), **{"mat-sound": raising(OSError("deaf"))})
    steps = list(islice(explore(prior, broken, repeat=True), 200))
    assert steps[-1].stop is not None
    all_broken = FunctionRobot(dict.fromkeys(prior.network.actions, raising(OSError("off"))))
    assert len(list(islice(explore(prior, all_broken, repeat=True, stopping=NothingLeft()), 200))) == 6


def test_costs_can_be_changed(prior: ExactBelief) -> None:
    """Costs given replace those of the network, in the steps and for the policy."""
    *_, last = explore(prior, mug(), costs_s={"weighing": 1e-6}, policy=GreedyPerCost(), stopping=StepBudget(1))
    assert last.total_cost_s == 1e-6


def test_random_exploration_repeats_with_its_seed(prior: ExactBelief) -> None:
    """The same generator seed gives the same actions and outcomes."""

    def run(seed: int) -> Any:
        robot = SampledRobot(prior.network, "wineglass", np.random.default_rng(seed))
        rng = np.random.default_rng(seed)
        return [(s.action, s.outcome) for s in explore(prior, robot, policy=Random(), rng=rng, stopping=NothingLeft())]

    assert run(3) == run(3)
    assert run(3) != run(4)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"costs_s": {"dance": 1.0}}, "unknown action 'dance'"),
        ({"costs_s": {"weighing": -1.0}}, "cost of action 'weighing' -1.0"),
        ({"objective": Learn("colour")}, "'colour'"),
        ({"objective": Weighted({Learn("colour"): 1.0})}, "'colour'"),
        (
            {"robot": FunctionRobot({"weighting": lambda: Label("x")})},
            r"robot FunctionRobot offers the unknown action 'weighting' \(did you mean 'weighing'\?\): choose from ",
        ),
    ],
)
def test_what_the_network_does_not_know_is_an_error(prior: ExactBelief, arguments: Any, told: str) -> None:
    """Unknown actions and properties, and costs below zero, are errors and no failed steps."""
    robot = arguments.pop("robot", mug())
    with pytest.raises(EvidenceError, match=told):
        list(explore(prior, robot, **arguments))


def test_a_policy_that_chooses_what_is_not_there_is_an_error(prior: ExactBelief) -> None:
    """A choice outside what is available is the policy's fault and is told."""

    class Wild(Greedy):
        def choose(self, choice: Choice) -> Any:
            return "dance"

    with pytest.raises(EvidenceError, match="the policy chose action 'dance': choose from"):
        next(explore(prior, mug(), policy=Wild()))


def test_nothing_happens_before_it_is_asked_for(prior: ExactBelief) -> None:
    """The loop is lazy: the robot acts only when the next step is asked for."""
    done = []

    def weigh() -> Reading:
        done.append("weighing")
        return Reading(1.0)

    robot = mug(weighing=weigh)
    steps = explore(prior, robot, policy=FixedOrder(["weighing"]))
    assert done == []
    next(steps)
    assert done == ["weighing"]


def test_what_a_robot_cannot_do_is_told_at_once(prior: ExactBelief) -> None:
    """A robot that offers an unknown action is refused before the first step is asked for."""
    with pytest.raises(EvidenceError, match="unknown action 'dance'"):
        explore(prior, mug(dance=lambda: Label("x")))


def test_steps_before_an_unknown_action_are_kept(prior: ExactBelief) -> None:
    """A robot that comes to offer an unknown action ends the exploration after the steps that were done."""
    offered = ["weighing", "mat-sound"]

    class Growing(FunctionRobot):
        def actions(self) -> Any:
            return tuple(offered)

        def perform(self, action: str) -> Outcome:
            offered.append("dance")
            return Failed("slipped")

    steps = explore(prior, Growing({}))
    assert isinstance(next(steps).outcome, Failed)
    with pytest.raises(EvidenceError, match="robot Growing offers the unknown action 'dance'"):
        next(steps)


def test_policies_know_what_is_left(prior: ExactBelief) -> None:
    """A choice tells the steps and the cost that the stopping rules leave, and no limit where they have none."""
    seen: list[Any] = []

    class Watching(Greedy):
        def choose(self, choice: Choice) -> Any:
            seen.append((choice.steps_left, choice.left_s))
            return super().choose(choice)

    steps = list(explore(prior, mug(), policy=Watching(), stopping=StepBudget(3) | StepBudget(2) | CostBudget(60.0)))
    assert seen == [(2, 60.0), (1, 60.0 - steps[0].cost_s)]
    seen.clear()
    list(explore(prior, mug(), policy=Watching(), stopping=NothingLeft()))
    assert set(seen) == {(np.inf, np.inf)}
