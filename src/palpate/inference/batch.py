"""Gains of a categorical objective for many beliefs over one network at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.inference.channels import OUTCOME
from palpate.inference.exact import ExactBelief
from palpate.inference.tables import outcome_table
from palpate.inference.tensors import Table, product
from palpate.information import TINY

__all__ = ["categorical_gains"]

Array = NDArray[np.float64]
LN2 = float(np.log(2))
BELIEF = "(belief)"


def categorical_gains(beliefs: Sequence[ExactBelief], properties: Sequence[str], actions: Sequence[str]) -> Array:
    """Expected gains [bits] of actions about categorical properties together, (beliefs, actions)."""
    gains = np.empty((len(beliefs), len(actions)))
    for column, action in enumerate(actions):
        by_table: dict[int, tuple[Array, tuple[str, ...], list[int]]] = {}
        for i, belief in enumerate(beliefs):
            table = outcome_table(belief, action)
            by_table.setdefault(id(table.values), (table.values, table.names[:-1], []))[2].append(i)
        for values, own, rows in by_table.values():
            joints = np.stack([beliefs[i].joint.values for i in rows])
            gains[rows, column] = _gains(joints, beliefs[0].parts.axes, tuple(properties), own, values)
    return gains


def _gains(
    joints: Array, axes: tuple[str, ...], properties: tuple[str, ...], own: tuple[str, ...], table: Array
) -> Array:
    """I(properties; outcome) of each joint table in the stack (B,) [bits]."""
    names = tuple(n for n in axes if n in properties or n in own)
    drop = tuple(i + 1 for i, n in enumerate(axes) if n not in names)
    kept = Table(joints.sum(axis=drop) if drop else joints, (BELIEF, *names))
    joint = product(kept, Table(table, (*own, OUTCOME)), (BELIEF, *properties, OUTCOME)).values
    joint = joint.reshape(len(joints), -1, table.shape[-1])
    outcome, states, total = joint.sum(axis=1), joint.sum(axis=2), joint.sum(axis=(1, 2))
    nats = _p_log_p(joint).sum(axis=(1, 2)) - _p_log_p(outcome).sum(axis=1) - _p_log_p(states).sum(axis=1)
    return np.asarray(np.maximum(nats + _p_log_p(total), 0.0) / LN2)


def _p_log_p(p: Array) -> Array:
    return np.asarray(p * np.log(np.maximum(p, TINY)))
