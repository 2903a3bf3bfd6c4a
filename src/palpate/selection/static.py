"""The best static set: actions chosen together beforehand, whatever their outcomes will be."""

from __future__ import annotations

from itertools import combinations

from palpate.errors import EvidenceError
from palpate.selection.foresight import foresight
from palpate.selection.policies import Choice

__all__ = ["StaticSet"]


class StaticSet:
    """The `size` different actions whose outcomes together tell most, in the order of their own gains.

    The set is chosen when an exploration begins, and kept: a policy is for one exploration at a time.

    Parameters
    ----------
    size
        How many actions, at least 1; all of them where there are fewer.
    """

    def __init__(self, size: int) -> None:
        if size < 1:
            raise EvidenceError(f"a static set of {size!r} actions was asked for, expected at least 1")
        self.size = size
        self._chosen: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"StaticSet({self.size})"

    def choose(self, choice: Choice) -> str | None:
        """Return the next action of the set; None when all have been taken."""
        if not choice.taken:
            self._chosen = self._best(choice)
        return next((a for a in self._chosen if a in choice.gains and a not in choice.taken), None)

    def _best(self, choice: Choice) -> tuple[str, ...]:
        if self.size >= len(choice.actions):
            return tuple(sorted(choice.actions, key=lambda action: -choice.gains[action]))
        plans = foresight(choice.belief, choice.objective, choice.actions, repeat=False)
        sets = combinations(choice.actions, self.size)
        best = max(sets, key=plans.together)
        return tuple(sorted(best, key=lambda action: -choice.gains[action]))
