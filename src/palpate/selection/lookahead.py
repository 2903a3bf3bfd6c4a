"""Adaptive look-ahead: the action that is best when the choices after it depend on its outcome."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from palpate.errors import EvidenceError
from palpate.selection.foresight import foresight
from palpate.selection.policies import Choice
from palpate.selection.purse import Purse

__all__ = ["LookAhead"]

TIE = 1e-9


def _untold(done: int, of: int) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class LookAhead:
    """The action with the largest expected information over the next `depth` actions.

    V_d(belief) = max over actions of gain + E over outcomes of V_(d-1)(belief after), with the
    exact expectation over labels and by quadrature over readings. Depth 1 is greedy. Plans are
    never longer or dearer than the steps and the cost that a budget leaves.

    Parameters
    ----------
    depth
        How many actions to look ahead, at least 1.
    told
        Called during a choice with the number of first actions that have been valued, and how many
        there are: choices can take long.

    Examples
    --------
    >>> LookAhead(2)
    LookAhead(depth=2)
    """

    depth: int
    told: Callable[[int, int], None] = field(default=_untold, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Refuse a depth that is none."""
        if self.depth < 1:
            raise EvidenceError(f"a look-ahead of depth {self.depth!r} was asked for, expected at least 1")

    def choose(self, choice: Choice) -> str:
        """Return the action with the largest value; among equals the one that tells most at once."""
        depth = max(1, int(min(self.depth, choice.steps_left)))
        purse = Purse(choice.left_s, choice.costs_s)
        plans = foresight(choice.belief, choice.objective, choice.actions, choice.repeat, purse)
        values: dict[str, float] = {}
        for action in choice.actions:
            self.told(len(values), len(choice.actions))
            values[action] = plans.best(action, depth)
        best = max(values.values())
        # Plans of the same actions in another order are worth the same, but for rounding.
        return max((a for a, value in values.items() if value > best - TIE), key=lambda a: choice.gains[a])
