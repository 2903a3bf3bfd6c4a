"""The information that several actions give together: adaptively, or as a set fixed beforehand.

Where outcomes are independent given the categorical properties and the objective is categorical,
all outcomes of a plan are worked out as one table; else the plan is walked belief by belief.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import prod

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError
from palpate.inference.belief import Belief
from palpate.inference.exact import ExactBelief
from palpate.inference.tables import independent, outcome_table, outcomes_of
from palpate.information import TINY
from palpate.network.properties import CategoricalProperty
from palpate.selection.objectives import Learn, Objective

__all__ = ["Tabled", "Walked", "foresight"]

Array = NDArray[np.float64]
Actions = tuple[str, ...]

LN2 = float(np.log(2))
MAX_ENTRIES = 100_000_000
NEGLIGIBLE = 1e-7
"""Outcomes less probable than this are left out when a plan is walked."""


def foresight(belief: Belief, objective: Objective, actions: Sequence[str], repeat: bool) -> Tabled | Walked:
    """What works out the value of plans made of these actions.

    Raises
    ------
    EvidenceError
        If the belief is not exact: other engines have no probabilities of outcomes.
    """
    if not isinstance(belief, ExactBelief):
        raise EvidenceError(f"looking ahead needs the exact engine, found {type(belief).__name__}")
    network = belief.network
    plain = isinstance(objective, Learn) and all(
        isinstance(network.property(p), CategoricalProperty) for p in objective.properties
    )
    if plain and not repeat and independent(belief, actions):
        return Tabled(belief, objective.properties, actions)
    return Walked(belief, objective, tuple(actions), repeat)


class Tabled:
    """Plans without repetition over independent outcomes: tables of all of them.

    Entries below are probabilities of outcomes of a set of actions (an axis each, in the
    network's order) and of a joint state, split into the objective's states z and the rest r.
    """

    def __init__(self, belief: ExactBelief, properties: Sequence[str], actions: Iterable[str]) -> None:
        tables = {name: outcome_table(belief, name) for name in actions}
        named = {n for t in tables.values() for n in t.names[:-1]} | set(properties)
        rest = tuple(n for n in belief.parts.axes if n in named and n not in properties)
        names = (*properties, *rest)
        joint = belief.categorical(names).values
        states = prod(joint.shape[: len(properties)])
        self._weights = joint.reshape(states, -1)
        self._tables: dict[str, Array] = {}
        for name, table in tables.items():
            own = table.names[:-1]
            values = table.values.transpose([*(own.index(n) for n in names if n in own), len(own)])
            shape = iter(values.shape)
            values = values.reshape([*(next(shape) if n in own else 1 for n in names), values.shape[-1]])
            full = np.broadcast_to(values, (*joint.shape, values.shape[-1]))
            self._tables[name] = np.ascontiguousarray(full.reshape(*self._weights.shape, -1))
        self._seen: dict[Actions, Array] = {(): self._weights}
        self._values: dict[tuple[Actions, int], Array] = {}

    def best(self, action: str, depth: int) -> float:
        """Information [bits] of an action and of the best adaptive choices after it, `depth` actions in all."""
        return float(self._after((), action, depth)) / LN2

    def together(self, actions: Sequence[str]) -> float:
        """Information [bits] of the outcomes of a fixed set of actions together."""
        order = sorted(actions, key=lambda name: self._tables[name].shape[-1])
        return self._set_nats(self._weights, order) / LN2

    def _set_nats(self, weights: Array, actions: Sequence[str]) -> float:
        """I(objective; outcomes) weighted by the mass of the weights (z, r) [nats]."""
        *inner, last = actions
        size = weights.size * prod(self._tables[a].shape[-1] for a in actions)
        if inner and size > MAX_ENTRIES / 10:  # one outcome of the first action at a time
            first = self._tables[actions[0]]
            below = sum(self._set_nats(weights * first[:, :, y], actions[1:]) for y in range(first.shape[-1]))
            return below + float(self._gain(weights[None], actions[0])[0])
        seen = weights[None]
        for name in inner:
            seen = np.einsum("bzr,zry->byzr", seen, self._tables[name]).reshape(-1, *weights.shape)
        joint = np.einsum("bzr,zry->zby", seen, self._tables[last]).reshape(len(weights), -1)
        z, y = weights.sum(axis=1), joint.sum(axis=0)
        return float(_p_log_p(joint).sum() - _p_log_p(z).sum() - _p_log_p(y).sum() + _p_log_p(z.sum()))

    def _outcomes(self, taken: Actions) -> Array:
        """Probabilities of the outcomes of a set of actions, and of z and r."""
        if taken not in self._seen:
            size = self._weights.size * prod(self._tables[a].shape[-1] for a in taken)
            if size > MAX_ENTRIES:
                raise EvidenceError(
                    f"looking ahead over {', '.join(taken)} needs {size:.1e} numbers, more than {MAX_ENTRIES:.0e}: "
                    "look less far ahead"
                )
            before = self._outcomes(taken[:-1])
            self._seen[taken] = np.einsum("...zr,zry->...yzr", before, self._tables[taken[-1]])
        return self._seen[taken]

    def _gain(self, weights: Array, action: str) -> Array:
        """I(objective; outcome) weighted by mass, for each leading index of the weights [nats]."""
        joint = np.einsum("...zr,zry->...zy", weights, self._tables[action], optimize=True)
        z = weights.sum(axis=-1)
        return np.asarray(
            _p_log_p(joint).sum(axis=(-2, -1))
            - _p_log_p(joint.sum(axis=-2)).sum(axis=-1)
            - _p_log_p(z).sum(axis=-1)
            + _p_log_p(z.sum(axis=-1))
        )

    def _after(self, taken: Actions, action: str, depth: int) -> Array:
        """Value of an action and the best that follows, for each outcome of the actions taken."""
        value = self._gain(self._outcomes(taken), action)
        if depth > 1 and len(taken) + 1 < len(self._tables):
            order = list(self._tables)
            more = tuple(sorted((*taken, action), key=order.index))
            value = value + self._value(more, depth - 1).sum(axis=more.index(action))
        return value

    def _value(self, taken: Actions, depth: int) -> Array:
        """Value of the best adaptive choices after each outcome of the actions taken."""
        if (taken, depth) not in self._values:
            left = [name for name in self._tables if name not in taken]
            options = [self._after(taken, name, depth) for name in left]
            self._values[taken, depth] = np.max(options, axis=0)
        return self._values[taken, depth]


def _p_log_p(p: Array) -> Array:
    return np.asarray(p * np.log(np.maximum(p, TINY)))


class Walked:
    """Plans of any kind: each outcome makes a belief, whose gains are asked for."""

    def __init__(self, belief: ExactBelief, objective: Objective, actions: Actions, repeat: bool) -> None:
        self._belief = belief
        self._objective = objective
        self._actions = actions
        self._repeat = repeat

    def best(self, action: str, depth: int) -> float:
        """Information [bits] of an action and of the best adaptive choices after it, `depth` actions in all."""
        return self._after(self._belief, action, depth, self._actions)

    def together(self, actions: Sequence[str]) -> float:
        """Information [bits] of the outcomes of a fixed sequence of actions."""
        return self._sequence(self._belief, tuple(actions))

    def _after(self, belief: ExactBelief, action: str, depth: int, actions: Actions) -> float:
        value = self._objective.gains(belief, [action])[action]
        left = actions if self._repeat else tuple(a for a in actions if a != action)
        if depth > 1 and left:
            for outcome, p in outcomes_of(belief, action):
                if p > NEGLIGIBLE:
                    after = belief.update(action, outcome)
                    value += p * self._value(after, depth - 1, left)
        return value

    def _value(self, belief: ExactBelief, depth: int, actions: Actions) -> float:
        if depth == 1:
            return max(self._objective.gains(belief, actions).values())
        return max(self._after(belief, action, depth, actions) for action in actions)

    def _sequence(self, belief: ExactBelief, actions: Actions) -> float:
        first, *rest = actions
        value = self._objective.gains(belief, [first])[first]
        if rest:
            for outcome, p in outcomes_of(belief, first):
                if p > NEGLIGIBLE:
                    value += p * self._sequence(belief.update(first, outcome), tuple(rest))
        return value
