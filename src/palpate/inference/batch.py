"""Gains of a categorical objective for many beliefs over one network at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.inference.exact import ExactBelief
from palpate.inference.tables import outcome_table
from palpate.information import TINY

__all__ = ["categorical_gains"]

Array = NDArray[np.float64]
LN2 = float(np.log(2))


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


def _gains(joints: Array, axes: tuple[str, ...], properties: tuple[str, ...], own: tuple[str, ...], table: Array) -> Array:
    """I(properties; outcome) of each joint table in the stack (B,) [bits]."""
    shared = [n for n in properties if n in own]
    number = {n: i + 1 for i, n in enumerate(axes)}
    names = tuple(dict.fromkeys((*properties, *own)))
    # (B, states...) -> (B, properties..., parents that are no objective...)
    drop = tuple(number[n] for n in axes if n not in names)
    left = [n for n in axes if n in names]
    kept = joints.sum(axis=drop) if drop else joints
    kept = kept.transpose([0, *(left.index(n) + 1 for n in names)])
    outcome = len(axes) + 1
    made = [0, *(number[n] for n in properties), outcome]
    if shared:
        seen = np.einsum(kept, [0, *(number[n] for n in names)], table, [*(number[n] for n in own), outcome], made)
    else:
        inner = int(np.prod([table.shape[i] for i in range(len(own))], dtype=int))
        seen = kept.reshape(-1, inner) @ table.reshape(inner, -1)
    joint = seen.reshape(len(joints), -1, table.shape[-1])
    nats = _p_log_p(joint).sum(axis=(1, 2)) - _p_log_p(joint.sum(axis=1)).sum(axis=1) - _p_log_p(joint.sum(axis=2)).sum(axis=1)
    return np.maximum(nats + _p_log_p(joint.sum(axis=(1, 2))), 0.0) / LN2


def _p_log_p(p: Array) -> Array:
    return np.asarray(p * np.log(np.maximum(p, TINY)))
