"""What tables of outcomes tell: information per objective from probabilities of outcomes and configurations.

Outcomes are independent given a configuration c of the categorical properties. Weights (..., c) are the
probabilities of a configuration and of what was seen before, for each leading index.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.inference.exact import ExactBelief
from palpate.inference.tables import noise_nats
from palpate.inference.tensors import Table
from palpate.information import p_log_p
from palpate.network.properties import CategoricalProperty
from palpate.selection.objectives import Everything, Learn, Objective, Weighted

__all__ = ["Aim", "aim", "can_aim", "parts", "spread"]

Array = NDArray[np.float64]


class Aim(Protocol):
    """An objective, as tables of outcomes tell about it."""

    def nats(self, weights: Array, action: str) -> Array:
        """I(objective; outcome) weighted by mass, for each leading index of the weights (..., c)."""


class _OfStates:
    """Information on categorical properties."""

    def __init__(self, properties: Sequence[str], joint: Table, tables: Mapping[str, Array]) -> None:
        sizes = dict(zip(joint.names, joint.values.shape, strict=True))
        ahead = (*properties, *(n for n in joint.names if n not in properties))
        places = np.arange(joint.values.size).reshape(joint.values.shape)
        order = places.transpose([joint.names.index(n) for n in ahead]).ravel()
        self._order = slice(None) if ahead == joint.names else order
        self._states = prod(sizes[n] for n in properties)
        self._tables = {
            name: table[self._order].reshape(self._states, -1, table.shape[-1]) for name, table in tables.items()
        }

    def nats(self, weights: Array, action: str) -> Array:
        """From the joint of the objective's states and the outcome."""
        split = weights[..., self._order].reshape(*weights.shape[:-1], self._states, -1)
        joint = np.einsum("...zr,zry->...zy", split, self._tables[action], optimize=True)
        z = split.sum(axis=-1)
        return np.asarray(
            p_log_p(joint).sum(axis=(-2, -1))
            - p_log_p(joint.sum(axis=-2)).sum(axis=-1)
            - p_log_p(z).sum(axis=-1)
            + p_log_p(z.sum(axis=-1))
        )


class _OfAll:
    """Information on everything, so on the property that an action measures: H(Y) - H(Y | that property)."""

    def __init__(self, tables: Mapping[str, Array], noise_nats: Mapping[str, Array]) -> None:
        self._tables = tables
        self._noise_nats = noise_nats

    def nats(self, weights: Array, action: str) -> Array:
        """From the probabilities of the outcome alone: the noise is the same whatever else was seen."""
        outcome = weights @ self._tables[action]
        before = p_log_p(weights.sum(axis=-1)) - p_log_p(outcome).sum(axis=-1)
        return np.asarray(before - weights @ self._noise_nats[action])


def parts(objective: Objective) -> list[tuple[Objective, float]]:
    """The objectives that a weighted one is made of, with their weights."""
    return list(objective.parts.items()) if isinstance(objective, Weighted) else [(objective, 1.0)]


def can_aim(belief: ExactBelief, part: Objective) -> bool:
    """Whether an objective is one that tables of outcomes tell about: categorical properties, or everything."""
    if isinstance(part, Everything):
        return True
    return isinstance(part, Learn) and all(
        isinstance(belief.network.property(p), CategoricalProperty) for p in part.properties
    )


def aim(part: Objective, belief: ExactBelief, joint: Table, own: Mapping[str, Table], full: Mapping[str, Array]) -> Aim:
    """An objective as an aim.

    Parameters
    ----------
    joint
        Of the categorical properties that matter.
    own, full
        p(outcome | configuration) of each action: over the properties it depends on, and over all of
        the joint's (c, outcomes).
    """
    if part.properties:
        return _OfStates(part.properties, joint, full)
    noise = {
        name: Table(noise_nats(belief, name).reshape(t.values.shape[:-1]), t.names[:-1]) for name, t in own.items()
    }
    return _OfAll(full, {name: spread(table, joint).ravel() for name, table in noise.items()})


def spread(table: Table, joint: Table) -> Array:
    """Lay a table over some of the joint's properties, and perhaps outcomes, out over all of them."""
    own = tuple(n for n in joint.names if n in table.names)
    outcomes = table.values.shape[len(own) :]
    values = table.values.transpose([*(table.names.index(n) for n in own), *range(len(own), table.values.ndim)])
    shape = iter(values.shape)
    values = values.reshape([*(next(shape) if n in own else 1 for n in joint.names), *outcomes])
    return np.ascontiguousarray(np.broadcast_to(values, (*joint.values.shape, *outcomes)))
