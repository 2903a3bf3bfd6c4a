"""Plans over outcomes that are independent given the categorical properties: one table of all of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import prod

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError
from palpate.inference.exact import ExactBelief
from palpate.inference.tables import independent, outcome_table
from palpate.inference.tensors import Table
from palpate.selection.aims import aim, can_aim, parts, spread
from palpate.selection.objectives import Objective
from palpate.selection.purse import Purse

__all__ = ["Tabled"]

Array = NDArray[np.float64]
Actions = tuple[str, ...]

LN2 = float(np.log(2))
MAX_ENTRIES = 100_000_000


class Tabled:
    """Plans without repetition over independent outcomes: tables of all of them.

    Entries below are probabilities of outcomes of a set of actions (an axis each, in the
    network's order) and of a configuration c of the categorical properties.
    """

    def __init__(
        self, belief: ExactBelief, objective: Objective, actions: Iterable[str], purse: Purse | None = None
    ) -> None:
        tables = {name: outcome_table(belief, name) for name in actions}
        names = _names(belief, objective, tables.values())
        joint = belief.categorical(names)
        self._weights = joint.values.ravel()
        self._tables = {name: spread(table, joint).reshape(joint.values.size, -1) for name, table in tables.items()}
        self._purse = purse or Purse()
        self._aims = [(aim(part, belief, joint, tables, self._tables), weight) for part, weight in parts(objective)]
        self._seen: dict[Actions, Array] = {(): self._weights}
        self._values: dict[tuple[Actions, int], Array] = {}

    @staticmethod
    def fits(belief: ExactBelief, objective: Objective, actions: Sequence[str]) -> bool:
        """Whether plans without repetition of these actions can be worked out in this way."""
        if not independent(belief, actions) or not all(can_aim(belief, part) for part, _ in parts(objective)):
            return False
        tables = [outcome_table(belief, name) for name in actions]
        states = belief.categorical(_names(belief, objective, tables)).values.size
        return bool(states * sum(table.values.shape[-1] for table in tables) <= MAX_ENTRIES)

    def best(self, action: str, depth: int) -> float:
        """Information [bits] of an action and of the best adaptive choices after it, `depth` actions in all."""
        return float(self._after((), action, depth)) / LN2

    def together(self, actions: Sequence[str]) -> float:
        """Information [bits] of the outcomes of a fixed set of actions together."""
        order = sorted(actions, key=lambda name: self._tables[name].shape[-1])
        return self._set_nats(self._weights[None], order) / LN2

    def _set_nats(self, weights: Array, actions: Sequence[str]) -> float:
        """Information of a set of actions weighted by the mass of the weights (B, c), by the chain rule [nats]."""
        first, *rest = actions
        value = float(self._gain(weights, first).sum())
        if not rest:
            return value
        table = self._tables[first]
        if weights.size * prod(self._tables[a].shape[-1] for a in actions) > MAX_ENTRIES / 10:
            return value + sum(self._set_nats(weights * table[:, y], rest) for y in range(table.shape[-1]))
        after = np.einsum("bc,cy->byc", weights, table).reshape(-1, weights.shape[-1])
        return value + self._set_nats(after, rest)

    def _outcomes(self, taken: Actions) -> Array:
        """Probabilities of the outcomes of a set of actions, and of c."""
        if taken not in self._seen:
            size = self._weights.size * prod(self._tables[a].shape[-1] for a in taken)
            if size > MAX_ENTRIES:
                raise EvidenceError(
                    f"looking ahead over {', '.join(taken)} needs {size:.1e} numbers, more than {MAX_ENTRIES:.0e}: "
                    "look less far ahead"
                )
            before = self._outcomes(taken[:-1])
            self._seen[taken] = np.einsum("...c,cy->...yc", before, self._tables[taken[-1]])
        return self._seen[taken]

    def _gain(self, weights: Array, action: str) -> Array:
        """I(objective; outcome) weighted by mass, for each leading index of the weights [nats]."""
        first, *others = (weight * part.nats(weights, action) for part, weight in self._aims)
        return sum(others, first)

    def _after(self, taken: Actions, action: str, depth: int) -> Array:
        """Value of an action and the best that follows, for each outcome of the actions taken."""
        value = self._gain(self._outcomes(taken), action)
        order = list(self._tables)
        more = tuple(sorted((*taken, action), key=order.index))
        if depth > 1 and self._left(more):
            value = value + self._value(more, depth - 1).sum(axis=more.index(action))
        return value

    def _left(self, taken: Actions) -> list[str]:
        return [name for name in self._tables if name not in taken and self._purse.affords((*taken, name))]

    def _value(self, taken: Actions, depth: int) -> Array:
        """Value of the best adaptive choices after each outcome of the actions taken."""
        if (taken, depth) not in self._values:
            options = [self._after(taken, name, depth) for name in self._left(taken)]
            self._values[taken, depth] = np.max(options, axis=0)
        return self._values[taken, depth]


def _names(belief: ExactBelief, objective: Objective, tables: Iterable[Table]) -> tuple[str, ...]:
    """The categorical properties that matter: the objective's, and those outcomes depend on."""
    # The objective's own stand first, where what tells about them need not be put in another order.
    aimed = dict.fromkeys(name for part, _ in parts(objective) for name in part.properties)
    named = {name for table in tables for name in table.names[:-1]}
    return (*aimed, *(name for name in belief.parts.axes if name in named and name not in aimed))
