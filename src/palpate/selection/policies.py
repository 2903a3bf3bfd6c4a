"""Policies: which action to take next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Protocol

import numpy as np

from palpate.selection.objectives import Objective

if TYPE_CHECKING:
    from palpate.inference.belief import Belief

__all__ = ["Choice", "FixedOrder", "Greedy", "GreedyPerCost", "Policy", "Random"]


@dataclass(frozen=True, eq=False)
class Choice:
    """All that a policy may look at.

    Parameters
    ----------
    gains
        Expected gain for the objective [bits] of each action that can be taken now; never empty.
    costs_s
        Cost of every action of the repertoire [s].
    taken
        The actions taken so far, in order.
    repeat
        Whether an action may be taken again.
    steps_left, left_s
        How many steps, and what cost [s], the stopping rule leaves; without limit unless given.
    """

    belief: Belief
    objective: Objective
    gains: Mapping[str, float]
    costs_s: Mapping[str, float]
    rng: np.random.Generator
    taken: Sequence[str] = field(default=())
    repeat: bool = False
    steps_left: float = inf
    left_s: float = inf

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that can be taken now, in the order of the network."""
        return tuple(self.gains)


class Policy(Protocol):
    """Chooses the next action."""

    def choose(self, choice: Choice) -> str | None:
        """One of ``choice.actions``; None where the policy wants none of them."""


@dataclass(frozen=True)
class Greedy:
    """The action with the largest expected gain; the first of the network's order among equals."""

    def choose(self, choice: Choice) -> str:
        """Return the action with the largest gain."""
        return max(choice.actions, key=lambda action: choice.gains[action])


@dataclass(frozen=True)
class GreedyPerCost:
    """The action with the largest expected gain per second; what costs nothing comes first."""

    def choose(self, choice: Choice) -> str:
        """Return the action with the largest gain per cost."""
        return max(choice.actions, key=lambda action: self._worth(choice.gains[action], choice.costs_s[action]))

    @staticmethod
    def _worth(gain: float, cost_s: float) -> tuple[float, float]:
        if cost_s > 0:
            return gain / cost_s, gain
        return (inf if gain > 0 else 0.0), gain


@dataclass(frozen=True)
class Random:
    """Any action, all as likely, drawn from the exploration's generator."""

    def choose(self, choice: Choice) -> str:
        """Return an action drawn at random."""
        return choice.actions[int(choice.rng.integers(len(choice.actions)))]


@dataclass(frozen=True)
class FixedOrder:
    """The actions given, in their order; what cannot be taken when its turn comes is passed over.

    Examples
    --------
    >>> FixedOrder(["weighing", "squeezing"])
    FixedOrder(order=('weighing', 'squeezing'))
    """

    order: Sequence[str]

    def __post_init__(self) -> None:
        object.__setattr__(self, "order", tuple(self.order))

    def choose(self, choice: Choice) -> str | None:
        """Return the next action of the order; None at its end."""
        taken = list(choice.taken)
        for action in self.order:
            if action in taken:
                taken.remove(action)
            elif action in choice.gains:
                return action
        return None
