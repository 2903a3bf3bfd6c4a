"""Adaptive look-ahead: the action that is best when the choices after it depend on its outcome."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.errors import EvidenceError
from palpate.selection.foresight import foresight
from palpate.selection.policies import Choice

__all__ = ["LookAhead"]

TIE = 1e-9


@dataclass(frozen=True)
class LookAhead:
    """The action with the largest expected information over the next `depth` actions.

    V_d(belief) = max over actions of gain + E over outcomes of V_(d-1)(belief after), with the
    exact expectation over labels and by quadrature over readings. Depth 1 is greedy.

    Parameters
    ----------
    depth
        How many actions to look ahead, at least 1.

    Examples
    --------
    >>> LookAhead(2)
    LookAhead(depth=2)
    """

    depth: int

    def __post_init__(self) -> None:
        """Refuse a depth that is none."""
        if self.depth < 1:
            raise EvidenceError(f"a look-ahead of depth {self.depth!r} was asked for, expected at least 1")

    def choose(self, choice: Choice) -> str:
        """Return the action with the largest value; among equals the one that tells most at once."""
        plans = foresight(choice.belief, choice.objective, choice.actions, choice.repeat)
        values = {action: plans.best(action, self.depth) for action in choice.actions}
        best = max(values.values())
        # Plans of the same actions in another order are worth the same, but for rounding.
        return max((a for a, value in values.items() if value > best - TIE), key=lambda a: choice.gains[a])
