"""The loop: choose an action, let the robot do it, update the belief, until a rule says stop."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from palpate.inference.belief import Belief
from palpate.loop import Loop, State, decide, learn, offered, set_up
from palpate.network.admission import AdmittedOutcome
from palpate.outcomes import Outcome
from palpate.robots.protocol import Robot
from palpate.robots.trial import attempt
from palpate.selection.objectives import Objective
from palpate.selection.policies import Policy
from palpate.selection.stopping import StoppingRule

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
        An action that the robot offers or of `costs_s`, or a property of the objective, is unknown;
        what is wrong from the start is told before the first step.
    """
    (loop,) = set_up(
        belief,
        [robot],
        [rng or np.random.default_rng()],
        objective=objective,
        policy=policy,
        stopping=stopping,
        repeat=repeat,
        costs_s=costs_s,
        timeout_s=timeout_s,
    )
    return _steps(loop, State(belief))


def _steps(loop: Loop, state: State) -> Iterator[Step]:
    while True:
        affordable, too_dear = offered(loop, state)
        gains = loop.objective.gains(state.belief, affordable) if affordable else {}
        index = len(state.taken) + 1
        action, reason = decide(loop, state, gains, too_dear)
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
        assert step.outcome is not None
        state = state.advanced(action, step.outcome, step.after, step.cost_s)


def _take(loop: Loop, state: State, action: str, gains: Mapping[str, float]) -> Step:
    """Do the action and update the belief."""
    before = state.belief
    outcome, admitted, after = learn(before, action, attempt(loop.robot, action, loop.timeout_s))
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
