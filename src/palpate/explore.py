"""The loop: choose an action, let the robot do it, update the belief, until a rule says stop."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

import numpy as np

from palpate.errors import EvidenceError, choices
from palpate.inference.belief import Belief
from palpate.network.admission import Admitted, AdmittedOutcome, admit
from palpate.outcomes import Failed, Outcome
from palpate.robots.protocol import Robot
from palpate.robots.trial import attempt
from palpate.selection.objectives import Everything, Objective
from palpate.selection.policies import Choice, Greedy, Policy
from palpate.selection.stopping import GainBelow, Situation, StoppingRule

__all__ = ["Step", "explore"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """One step of an exploration; the last one only says why it stopped.

    Parameters
    ----------
    index
        1 for the first step.
    gains_bits
        Expected gain for the objective of each action that could be taken.
    action, outcome
        The action taken and what it returned; None in the last step.
    admitted
        The outcome in the form in which the belief used it.
    notices
        What was decided when the outcome was admitted.
    realised_gain_bits
        KL(belief after || belief before) of the objective; None where the engine has none.
    entropy_drop_bits
        Entropy before less entropy after; None unless the objective is categorical.
    surprise
        Probability, before, of an outcome at least as unlikely; None for vectors and failures.
    stop
        Why exploration stopped; None but in the last step.
    """

    index: int
    gains_bits: Mapping[str, float]
    before: Belief
    after: Belief
    total_cost_s: float
    action: str | None = None
    outcome: Outcome | None = None
    admitted: AdmittedOutcome | None = None
    notices: tuple[str, ...] = ()
    cost_s: float = 0.0
    expected_gain_bits: float | None = None
    realised_gain_bits: float | None = None
    entropy_drop_bits: float | None = None
    surprise: float | None = None
    stop: str | None = None


@dataclass(frozen=True, eq=False)
class _Loop:
    """What stays the same while exploring."""

    robot: Robot
    objective: Objective
    policy: Policy
    stopping: StoppingRule
    repeat: bool
    rng: np.random.Generator
    costs_s: Mapping[str, float]
    timeout_s: float | None


@dataclass(frozen=True, eq=False)
class _State:
    """What changes from step to step."""

    belief: Belief
    spent_s: float = 0.0
    taken: tuple[str, ...] = ()
    failed_since: frozenset[str] = field(default=frozenset())


def explore(
    belief: Belief,
    robot: Robot,
    *,
    objective: Objective | None = None,
    policy: Policy | None = None,
    stopping: StoppingRule | None = None,
    repeat: bool = False,
    rng: np.random.Generator | None = None,
    costs_s: Mapping[str, float] | None = None,
    timeout_s: float | None = None,
) -> Iterator[Step]:
    """Explore an object, one step at each turn of the iteration.

    An action that raises, takes longer than `timeout_s`, returns `Failed` or an outcome that the
    network cannot use is recorded as failed with the reason, costs its cost, and exploration goes on.

    Parameters
    ----------
    belief
        What is known before; the prior for a new object.
    objective
        What to learn; everything, unless given.
    policy
        Chooses the next action; the largest expected gain, unless given.
    stopping
        When to stop; when the best expected gain is below 0.05 bits, unless given.
    repeat
        Whether an action may be taken again. One that failed waits until another one succeeded.
    rng
        Chance for policies that use it; unseeded unless given.
    costs_s
        Costs of actions [s] that differ from the network's.
    timeout_s
        Longest time an action may take [s]; no limit where None. A call that takes longer is
        left to itself, so the robot must bear to be asked again while it still runs.

    Yields
    ------
    Step
        One per action, and a last one without action that holds the reason to stop and the gains
        of what was left.

    Raises
    ------
    EvidenceError
        An action of the robot or of `costs_s`, or a property of the objective, is unknown.
    """
    loop = _Loop(
        robot,
        objective or Everything(),
        policy or Greedy(),
        stopping or GainBelow(),
        repeat,
        rng or np.random.default_rng(),
        _costs(belief, costs_s or {}),
        timeout_s,
    )
    return _steps(loop, _State(belief))


def _steps(loop: _Loop, state: _State) -> Iterator[Step]:
    while True:
        gains, too_dear = _options(loop, state)
        index = len(state.taken) + 1
        action, reason = _decide(loop, state, gains, too_dear)
        if action is None:
            yield Step(
                index=index,
                gains_bits=gains,
                before=state.belief,
                after=state.belief,
                total_cost_s=state.spent_s,
                stop=reason,
            )
            return
        step = _take(loop, state, action, gains)
        yield step
        state = _next(state, step)


def _options(loop: _Loop, state: _State) -> tuple[dict[str, float], tuple[str, ...]]:
    """Gains of the actions that can be taken, and the actions that only lack of budget forbids."""
    network = state.belief.network
    offered = {network.action(name).name for name in loop.robot.actions()}
    barred = state.failed_since if loop.repeat else set(state.taken)
    left = [name for name in network.actions if name in offered and name not in barred]
    # A sum of costs that should meet the budget exactly may exceed it by rounding.
    room = loop.stopping.budget_s - state.spent_s + 1e-9
    affordable = [name for name in left if loop.costs_s[name] <= room]
    gains = loop.objective.gains(state.belief, affordable) if affordable else {}
    return gains, tuple(name for name in left if name not in gains)


def _decide(
    loop: _Loop, state: _State, gains: Mapping[str, float], too_dear: Sequence[str]
) -> tuple[str | None, str | None]:
    """Return the action to take, or None and why to stop."""
    situation = Situation(state.belief, gains, loop.costs_s, state.spent_s, state.taken, too_dear)
    reason = loop.stopping.reason(situation)
    if reason is not None:
        return None, reason
    if not gains:
        return None, "no action is left that the budget allows" if too_dear else "no action is left"
    action = loop.policy.choose(
        Choice(state.belief, loop.objective, gains, loop.costs_s, loop.rng, state.taken, loop.repeat)
    )
    if action is None:
        return None, "the policy has come to its end"
    if action not in gains:
        raise EvidenceError(f"the policy chose action {action!r}: {choices(gains)}")
    return action, None


def _take(loop: _Loop, state: _State, action: str, gains: Mapping[str, float]) -> Step:
    """Do the action and update the belief."""
    before = state.belief
    outcome, admitted, after = _learn(before, action, attempt(loop.robot, action, loop.timeout_s))
    return Step(
        index=len(state.taken) + 1,
        gains_bits=gains,
        before=before,
        after=after,
        total_cost_s=state.spent_s + loop.costs_s[action],
        action=action,
        outcome=outcome,
        admitted=admitted.outcome,
        notices=admitted.notices,
        cost_s=loop.costs_s[action],
        expected_gain_bits=gains[action],
        realised_gain_bits=loop.objective.realised(before, after),
        entropy_drop_bits=loop.objective.entropy_drop(before, after),
        surprise=before.surprise(action, outcome),
    )


def _learn(before: Belief, action: str, outcome: Outcome) -> tuple[Outcome, Admitted, Belief]:
    """Update the belief; an outcome that the network cannot use counts as failed."""
    try:
        return outcome, admit(before.network, action, outcome), before.update(action, outcome)
    except EvidenceError as error:
        failed = Failed(f"not usable: {error}")
        return failed, Admitted(failed), before.update(action, failed)


def _next(state: _State, step: Step) -> _State:
    assert step.action is not None
    # An action that fails leaves the belief, and so its own gain, as they are: it would be chosen
    # for ever if it did not have to wait.
    failed = state.failed_since | {step.action} if isinstance(step.outcome, Failed) else frozenset()
    return replace(
        state,
        belief=step.after,
        spent_s=step.total_cost_s,
        taken=(*state.taken, step.action),
        failed_since=failed,
    )


def _costs(belief: Belief, given: Mapping[str, float]) -> dict[str, float]:
    """Costs of all actions [s], those of the network unless given."""
    for name, cost_s in given.items():
        belief.network.action(name)
        if not (isfinite(cost_s) and cost_s >= 0):
            raise EvidenceError(f"cost of action {name!r} {cost_s!r} was found, expected seconds, zero or above")
    return {name: given.get(name, action.cost_s) for name, action in belief.network.actions.items()}
