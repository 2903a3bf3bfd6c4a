"""Many explorations at once: in step with each other, gains worked out for all of them together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from palpate.errors import EvidenceError
from palpate.inference.batch import gains, updated
from palpate.inference.belief import Observation
from palpate.inference.exact import ExactBelief
from palpate.loop import Loop, State, decide, learn, offered, set_up
from palpate.network.admission import Admitted, AdmittedOutcome, admit
from palpate.outcomes import Outcome
from palpate.robots.protocol import Robot
from palpate.robots.trial import attempt
from palpate.selection.objectives import Everything, Learn, Objective
from palpate.selection.policies import Policy
from palpate.selection.stopping import StoppingRule

__all__ = ["Run", "explore_many"]


@dataclass(eq=False)
class Run:
    """One of many explorations, step by step.

    Attributes
    ----------
    beliefs
        The belief before each action, and the last one: one more than there are actions.
    gains_bits
        Expected gain for the objective of each action that could be taken, as often as `beliefs`.
    actions, outcomes
        What was done and what it returned, in the form in which the belief used it.
    total_cost_s
        Cost of all actions [s].
    stop
        Why the exploration stopped.
    """

    beliefs: list[ExactBelief]
    gains_bits: list[Mapping[str, float]] = field(default_factory=list)
    actions: list[str] = field(default_factory=list)
    outcomes: list[AdmittedOutcome] = field(default_factory=list)
    total_cost_s: float = 0.0
    stop: str = ""


def explore_many(
    belief: ExactBelief,
    robots: Sequence[Robot],
    *,
    objective: Objective | None = None,
    policy: Policy | None = None,
    stopping: StoppingRule | None = None,
    repeat: bool = False,
    rng: np.random.Generator | None = None,
    costs_s: Mapping[str, float] | None = None,
) -> list[Run]:
    """Explore with each robot, all of them in step.

    The choices, outcomes and beliefs are those of `explore` one by one, with the policy's chance
    from ``rng.spawn(len(robots))``, and gains are to 1e-9: where two tie to that, choices may
    differ. Realised gains and surprise are left to those who ask the beliefs. Policies that keep
    something between their choices, as `StaticSet` does, are for one exploration at a time.

    Parameters
    ----------
    belief, objective, policy, stopping, repeat, costs_s
        As for `explore`.
    robots
        One per exploration.

    Returns
    -------
    list of Run
        One per robot, in their order.

    Examples
    --------
    >>> import numpy as np, palpate
    >>> network = palpate.load_network("household-filled")
    >>> robots = [palpate.SampledRobot(network, "ceramic_mug", np.random.default_rng(seed)) for seed in range(3)]
    >>> runs = palpate.explore_many(palpate.ExactBelief(network), robots, objective=palpate.Learn("material"))
    >>> {run.actions[0] for run in runs}
    {'mat-sound'}
    """
    rngs = (rng or np.random.default_rng()).spawn(len(robots))
    loops = set_up(
        belief,
        robots,
        rngs,
        objective=objective,
        policy=policy,
        stopping=stopping,
        repeat=repeat,
        costs_s=costs_s,
    )
    states = [State(belief)] * len(loops)
    runs = [Run([belief]) for _ in robots]
    going = list(range(len(runs)))
    while going:
        options = [offered(loops[i], states[i]) for i in going]
        beliefs = [runs[i].beliefs[-1] for i in going]
        found = _gains(loops[0].objective, beliefs, [affordable for affordable, _ in options])
        acted: list[tuple[int, str]] = []
        for i, row, (_, too_dear) in zip(going, found, options, strict=True):
            runs[i].gains_bits.append(row)
            action, reason = decide(loops[i], states[i], row, too_dear)
            if action is None:
                runs[i].stop = reason or ""
            else:
                acted.append((i, action))
        _turn(loops, states, runs, acted)
        going = [i for i, _ in acted]
    return runs


def _turn(loops: Sequence[Loop], states: list[State], runs: Sequence[Run], acted: Sequence[tuple[int, str]]) -> None:
    """Take the actions and note what came of them."""
    befores = [runs[i].beliefs[-1] for i, _ in acted]
    outcomes = [attempt(loops[i].robot, action) for i, action in acted]
    learnt = _learn(befores, [action for _, action in acted], outcomes)
    for (i, action), (outcome, admitted, after) in zip(acted, learnt, strict=True):
        cost_s = loops[i].costs_s[action]
        runs[i].actions.append(action)
        runs[i].outcomes.append(admitted.outcome)
        runs[i].beliefs.append(after)
        runs[i].total_cost_s += cost_s
        states[i] = states[i].advanced(action, outcome, after, cost_s)


def _learn(
    befores: Sequence[ExactBelief], actions: Sequence[str], outcomes: Sequence[Outcome]
) -> list[tuple[Outcome, Admitted, ExactBelief]]:
    """Update the beliefs together."""
    try:
        admitted = [admit(b.network, a, o) for b, a, o in zip(befores, actions, outcomes, strict=True)]
        seen = [Observation(action, new.outcome) for action, new in zip(actions, admitted, strict=True)]
        return list(zip(outcomes, admitted, updated(befores, seen), strict=True))
    except EvidenceError:
        # An outcome cannot be used; which one, and that it counts as failed, shows one by one.
        return [learn(b, a, o) for b, a, o in zip(befores, actions, outcomes, strict=True)]


def _gains(
    objective: Objective, beliefs: Sequence[ExactBelief], options: Sequence[Sequence[str]]
) -> list[dict[str, float]]:
    """Expected gains [bits] of each belief's options."""
    if isinstance(objective, Learn | Everything):
        return gains(beliefs, objective.key, options)
    return [objective.gains(b, own) if own else {} for b, own in zip(beliefs, options, strict=True)]
