"""One turn of an exploration: what can be done, what to do, what it taught."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import TypeVar

import numpy as np

from palpate.errors import EvidenceError, choices, near
from palpate.inference.belief import Belief
from palpate.network.admission import Admitted, admit
from palpate.network.model import Network
from palpate.outcomes import Failed, Outcome
from palpate.robots.protocol import Robot
from palpate.selection.objectives import Everything, Objective
from palpate.selection.policies import Choice, Greedy, Policy
from palpate.selection.purse import Purse
from palpate.selection.stopping import GainBelow, Situation, StoppingRule

AnyBelief = TypeVar("AnyBelief", bound=Belief)

__all__ = ["Loop", "State", "check_robot", "decide", "learn", "offered", "set_up"]


@dataclass(frozen=True, eq=False)
class Loop:
    """What stays the same while exploring."""

    robot: Robot
    objective: Objective
    policy: Policy
    stopping: StoppingRule
    repeat: bool
    rng: np.random.Generator
    costs_s: Mapping[str, float]
    timeout_s: float | None = None


@dataclass(frozen=True, eq=False)
class State:
    """What changes from step to step."""

    belief: Belief
    spent_s: float = 0.0
    taken: tuple[str, ...] = ()
    failed_since: frozenset[str] = field(default=frozenset())

    def advanced(self, action: str, outcome: Outcome, after: Belief, cost_s: float) -> State:
        """The state after an action."""
        # An action that fails leaves the belief, and so its own gain, as they are: it would be chosen
        # for ever if it did not have to wait.
        failed = self.failed_since | {action} if isinstance(outcome, Failed) else frozenset[str]()
        return State(after, self.spent_s + cost_s, (*self.taken, action), failed)


def set_up(
    belief: Belief,
    robots: Sequence[Robot],
    rngs: Sequence[np.random.Generator],
    *,
    objective: Objective | None = None,
    policy: Policy | None = None,
    stopping: StoppingRule | None = None,
    repeat: bool = False,
    costs_s: Mapping[str, float] | None = None,
    timeout_s: float | None = None,
) -> list[Loop]:
    """A loop for each robot and its generator, with the defaults of `palpate.explore.explore`.

    Raises
    ------
    EvidenceError
        A robot offers an action that the network does not know, or a cost is of none or is no cost.
    """
    costs = _all_costs(belief, costs_s or {})
    for robot in robots:
        check_robot(belief.network, robot)
    objective, policy, stopping = objective or Everything(), policy or Greedy(), stopping or GainBelow()
    return [
        Loop(robot, objective, policy, stopping, repeat, rng, costs, timeout_s)
        for robot, rng in zip(robots, rngs, strict=True)
    ]


def check_robot(network: Network, robot: Robot) -> tuple[str, ...]:
    """The actions that a robot offers; EvidenceError if the network does not know one of them."""
    names = tuple(robot.actions())
    for name in names:
        if name not in network.actions:
            found = repr(name) + near(name, network.actions)
            raise EvidenceError(
                f"robot {type(robot).__name__} offers the unknown action {found}: {choices(network.actions)}"
            )
    return names


def offered(loop: Loop, state: State) -> tuple[list[str], tuple[str, ...]]:
    """The actions that can be taken, and those that only lack of budget forbids."""
    network = state.belief.network
    able = check_robot(network, loop.robot)
    barred = state.failed_since if loop.repeat else set(state.taken)
    left = [name for name in network.actions if name in able and name not in barred]
    purse = Purse(loop.stopping.budget_s - state.spent_s, loop.costs_s)
    affordable = [name for name in left if purse.affords([name])]
    return affordable, tuple(name for name in left if name not in affordable)


def decide(
    loop: Loop, state: State, gains: Mapping[str, float], too_dear: Sequence[str]
) -> tuple[str | None, str | None]:
    """Return the action to take, or None and why to stop.

    Raises
    ------
    EvidenceError
        If the policy chose an action that cannot be taken.
    """
    situation = Situation(state.belief, gains, loop.costs_s, state.spent_s, state.taken, too_dear)
    reason = loop.stopping.reason(situation)
    if reason is not None:
        return None, reason
    if not gains:
        return None, "no action is left that the budget allows" if too_dear else "no action is left"
    action = loop.policy.choose(
        Choice(
            state.belief,
            loop.objective,
            gains,
            loop.costs_s,
            loop.rng,
            state.taken,
            loop.repeat,
            loop.stopping.most_steps - len(state.taken),
            loop.stopping.budget_s - state.spent_s,
        )
    )
    if action is None:
        return None, "the policy has come to its end"
    if action not in gains:
        raise EvidenceError(f"the policy chose action {action!r}{near(action, gains)}: {choices(gains)}")
    return action, None


def learn(before: AnyBelief, action: str, outcome: Outcome) -> tuple[Outcome, Admitted, AnyBelief]:
    """Update the belief; an outcome that the network cannot use counts as failed."""
    try:
        return outcome, admit(before.network, action, outcome), before.update(action, outcome)
    except EvidenceError as error:
        failed = Failed(f"not usable: {error}")
        return failed, Admitted(failed), before.update(action, failed)


def _all_costs(belief: Belief, given: Mapping[str, float]) -> dict[str, float]:
    """Costs of all actions [s], those of the network unless given."""
    for name, cost_s in given.items():
        belief.network.action(name)
        if not (isfinite(cost_s) and cost_s >= 0):
            raise EvidenceError(f"cost of action {name!r} {cost_s!r} was found, expected seconds, zero or above")
    return {name: given.get(name, action.cost_s) for name, action in belief.network.actions.items()}
