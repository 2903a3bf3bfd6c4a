"""Plans of any kind: each outcome makes a belief, whose gains are asked for."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.inference.exact import ExactBelief
from palpate.inference.tables import outcomes_of
from palpate.outcomes import Outcome
from palpate.selection.objectives import Objective
from palpate.selection.purse import Purse

__all__ = ["Walked"]

NEGLIGIBLE = 1e-7
"""Outcomes less probable than this are left out when a plan is walked."""

Seen = frozenset[tuple[str, Outcome, int]]


class Walked:
    """Plans of any kind, walked belief by belief.

    Outcomes of the same actions in another order give the same belief, which is worked out once.
    """

    def __init__(
        self,
        belief: ExactBelief,
        objective: Objective,
        actions: Sequence[str],
        repeat: bool,
        purse: Purse | None = None,
    ) -> None:
        self._belief = belief
        self._objective = objective
        self._actions = tuple(actions)
        self._repeat = repeat
        self._purse = purse or Purse()
        self._values: dict[tuple[Seen, int], float] = {}

    def best(self, action: str, depth: int) -> float:
        """Information [bits] of an action and of the best adaptive choices after it, `depth` actions in all."""
        gain = self._objective.gains(self._belief, [action])[action]
        return gain + self._ahead(self._belief, (), action, depth)

    def together(self, actions: Sequence[str]) -> float:
        """Information [bits] of the outcomes of a fixed sequence of actions."""
        return self._sequence(self._belief, tuple(actions))

    def _ahead(self, belief: ExactBelief, past: tuple[tuple[str, Outcome], ...], action: str, depth: int) -> float:
        """Expected value of the best choices that follow an action."""
        left = self._left((*(name for name, _ in past), action)) if depth > 1 else []
        if not left:
            return 0.0
        return sum(
            p * self._value(belief, (*past, (action, outcome)), left, depth - 1)
            for outcome, p in outcomes_of(belief, action)
            if p > NEGLIGIBLE
        )

    def _left(self, taken: Sequence[str]) -> list[str]:
        return [a for a in self._actions if (self._repeat or a not in taken) and self._purse.affords((*taken, a))]

    def _value(
        self, before: ExactBelief, past: tuple[tuple[str, Outcome], ...], left: Sequence[str], depth: int
    ) -> float:
        """Value of the best adaptive choices after one more outcome, the last of the past."""
        key = frozenset((*seen, past.count(seen)) for seen in past), depth
        if key not in self._values:
            belief = before.update(*past[-1])
            gains = self._objective.gains(belief, left)
            self._values[key] = max(gains[a] + self._ahead(belief, past, a, depth) for a in left)
        return self._values[key]

    def _sequence(self, belief: ExactBelief, actions: Sequence[str]) -> float:
        first, *rest = actions
        value = self._objective.gains(belief, [first])[first]
        if rest:
            for outcome, p in outcomes_of(belief, first):
                if p > NEGLIGIBLE:
                    value += p * self._sequence(belief.update(first, outcome), rest)
        return value
