"""Evidence as the oracle reads it: plain dictionaries, in the properties' own units.

An item is ``{"action": name}`` with one of ``label``, ``likelihood``, ``posterior`` (with
``training_prior`` and ``temperature``), ``value``, ``above``, ``below`` (each with ``sd``) or
``failed``: the format of the command line, read here by code of the oracle's own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.network.sensors import ConfusionSensor

Array = NDArray[np.float64]
Item = Mapping[str, Any]


def vector(item: Item, states: Sequence[str]) -> Array | None:
    """The likelihood of a vector item, scaled to maximum one; None for other items."""
    if "likelihood" in item:
        values = np.array([float(item["likelihood"][state]) for state in states])
        return np.asarray(values / values.max())
    if "posterior" not in item:
        return None
    whole = sum(item["posterior"].values())
    given = {label: value / whole for label, value in item["posterior"].items()}
    p = np.array([float(given.get(state, 0.0)) for state in states])
    unknown = sum(value for label, value in given.items() if label not in states)
    empty = p < 1e-5
    if unknown > 0 and empty.any():
        p = p + unknown * empty / empty.sum()
    p = (p / p.sum()) ** (1 / float(item.get("temperature", 1.0)))
    p = p / p.sum()
    if item.get("training_prior"):
        p = p / np.array([float(item["training_prior"][state]) for state in states])
    return np.asarray(np.maximum(p / p.max(), 1e-3))


def looks(sensor: ConfusionSensor, labels: Sequence[str]) -> Array:
    """P(hidden label, labels | state), hidden x states: each look repeats the hidden one or not."""
    rho, table = sensor.repeat_probability, np.asarray(sensor.table)
    joint = np.zeros_like(table)
    for hidden in range(table.shape[0]):
        for state in range(table.shape[1]):
            value = table[hidden, state]
            for label in labels:
                seen = sensor.outcomes.index(label)
                value *= (rho if seen == hidden else 0.0) + (1 - rho) * table[seen, state]
            joint[hidden, state] = value
    return joint


def next_look(sensor: ConfusionSensor, labels: Sequence[str]) -> Array:
    """P(next label | state, labels so far), outcomes x states."""
    joint = looks(sensor, labels)
    total = joint.sum(axis=0)
    weight = np.where(total > 0, joint / np.where(total > 0, total, 1.0), sensor.table)
    return sensor.repeat_probability * weight + (1 - sensor.repeat_probability) * np.asarray(sensor.table)
