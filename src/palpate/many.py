"""Many explorations at once: in step with each other, gains worked out for all of them together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from palpate.inference.batch import categorical_gains
from palpate.inference.exact import ExactBelief
from palpate.loop import Loop, State, all_costs, decide, learn, offered
from palpate.network.admission import AdmittedOutcome
from palpate.network.properties import CategoricalProperty
from palpate.robots.protocol import Robot
from palpate.robots.trial import attempt
from palpate.selection.objectives import Everything, Learn, Objective
from palpate.selection.policies import Greedy, Policy
from palpate.selection.stopping import GainBelow, StoppingRule

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
    costs = all_costs(belief, costs_s or {})
    aim, chooser, rule = objective or Everything(), policy or Greedy(), stopping or GainBelow()
    loops = [Loop(robot, aim, chooser, rule, repeat, own, costs, None) for robot, own in zip(robots, rngs, strict=True)]
    states = [State(belief)] * len(loops)
    runs = [Run([belief]) for _ in robots]
    going = list(range(len(runs)))
    while going:
        options = [offered(loops[i], states[i]) for i in going]
        gains = _gains(aim, [runs[i].beliefs[-1] for i in going], [affordable for affordable, _ in options])
        acted = []
        for i, row, (_, too_dear) in zip(going, gains, options, strict=True):
            runs[i].gains_bits.append(row)
            action, reason = decide(loops[i], states[i], row, too_dear)
            if action is None:
                runs[i].stop = reason or ""
                continue
            states[i] = _turn(loops[i], states[i], runs[i], action)
            acted.append(i)
        going = acted
    return runs


def _turn(loop: Loop, state: State, run: Run, action: str) -> State:
    """Take the action and note what came of it."""
    before = run.beliefs[-1]
    outcome, admitted, after = learn(before, action, attempt(loop.robot, action))
    run.actions.append(action)
    run.outcomes.append(admitted.outcome)
    run.beliefs.append(after)
    run.total_cost_s += loop.costs_s[action]
    return state.advanced(action, outcome, after, loop.costs_s[action])


def _gains(
    objective: Objective, beliefs: Sequence[ExactBelief], options: Sequence[Sequence[str]]
) -> list[dict[str, float]]:
    """Expected gains [bits] of each belief's options."""
    network = beliefs[0].network
    properties = objective.properties if isinstance(objective, Learn) else ()
    if not properties or not all(isinstance(network.property(p), CategoricalProperty) for p in properties):
        return [objective.gains(b, own) if own else {} for b, own in zip(beliefs, options, strict=True)]
    found: list[dict[str, float]] = [{} for _ in beliefs]
    for action in network.actions:
        rows = [i for i, own in enumerate(options) if action in own]
        if rows:
            column = categorical_gains([beliefs[i] for i in rows], properties, [action])[:, 0]
            for i, gain in zip(rows, column.tolist(), strict=True):
                found[i][action] = gain
    return found
