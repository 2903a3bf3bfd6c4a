"""Explorations along a tape to its end, with the note where the stopping rule would have ended them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from palpate.experiments.branches import Branches, Taken
from palpate.experiments.reproduction.arms import Arm
from palpate.selection.objectives import Learn
from palpate.selection.policies import Choice
from palpate.selection.stopping import Situation

__all__ = ["Goal", "Point", "episode"]


@dataclass(frozen=True)
class Goal:
    """What to learn: the sum of the gains about properties, as in the paper."""

    name: str
    properties: tuple[str, ...]


@dataclass(frozen=True)
class Point:
    """Where an exploration is before its next action, or at its end.

    Parameters
    ----------
    taken
        The actions so far.
    gains_bits
        Expected gain of each action that is left.
    stopped
        Whether the stopping rule had ended the exploration before the last action.
    stop
        Why it ends here; None where it goes on, or had ended before.
    """

    taken: Taken
    gains_bits: Mapping[str, float]
    stopped: bool
    stop: str | None


def episode(branches: Branches, arm: Arm, goal: Goal, rng: np.random.Generator) -> Iterator[Point]:
    """Explore a tape until no action is left.

    An arm's choices do not depend on when it stops, so this is the exploration without stopping
    and, up to the first point with a reason to stop, the one with it.

    Parameters
    ----------
    rng
        Of the policy's chance.
    """
    costs_s = {name: action.cost_s for name, action in branches.network.actions.items()}
    taken, stopped = Taken(), False
    while True:
        belief = branches.belief(taken)
        gains = branches.gains(taken, goal.properties)
        spent_s = sum(costs_s[action] for action in taken)
        reason = arm.stopping.reason(Situation(belief, gains, costs_s, spent_s, taken))
        yield Point(taken, gains, stopped, None if stopped else reason or (None if gains else "no action is left"))
        if not gains:
            return
        stopped = stopped or reason is not None
        action = arm.policy.choose(Choice(belief, Learn(*goal.properties), gains, costs_s, rng, taken))
        if action is None:
            return
        taken = (*taken, action)
