"""Outcomes given the joint state of the categorical properties, for many beliefs or many steps at once.

Given that state, outcomes of different actions are independent unless they measure properties of
one group of continuous properties, or are repetitions of one action that share something.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.inference.channels import OUTCOME
from palpate.inference.exact import ExactBelief
from palpate.inference.tensors import Table
from palpate.information import TINY
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Above, Below, Label, Outcome, Reading

__all__ = ["independent", "noise_nats", "outcome_table", "outcomes_of"]

Array = NDArray[np.float64]


def outcome_table(belief: ExactBelief, action: str) -> Table:
    """p(outcome | categorical properties) under a belief; the last axis sums to one.

    Readings are on the nodes of a mesh, its weights included, with an atom for each end at which
    the sensor saturates.
    """
    sensor = belief.network.action(action).sensor
    if isinstance(sensor, ConfusionSensor):
        labels = belief.labels_of(action) if sensor.repeat_probability else []
        values = sensor.predictive(labels).T if labels else sensor.by_state
        return Table(values, (sensor.property, OUTCOME))
    group = belief.groups[belief.parts.home[sensor.property]]
    return group.next_reading(sensor, belief.outcomes_of(action)).given


def noise_nats(belief: ExactBelief, action: str) -> Array:
    """What an outcome's entropy is on average given the measured property, per configuration (configurations,) [nats].

    Of readings it is counted so that -sum p ln p of `outcome_table`'s columns, less this, is the
    information about the measured property.
    """
    sensor = belief.network.action(action).sensor
    if isinstance(sensor, ConfusionSensor):
        table = outcome_table(belief, action).values
        return -np.asarray((table * np.log(np.maximum(table, TINY))).sum(axis=-1))
    group = belief.groups[belief.parts.home[sensor.property]]
    return group.next_reading(sensor, belief.outcomes_of(action)).noise.values.ravel()


def independent(belief: ExactBelief, actions: Sequence[str]) -> bool:
    """Whether single outcomes of these actions are independent given the categorical properties."""
    sensors = [belief.network.action(name).sensor for name in actions]
    homes = [belief.parts.home[s.property] for s in sensors if not isinstance(s, ConfusionSensor)]
    return len(set(homes)) == len(homes)


def outcomes_of(belief: ExactBelief, action: str) -> list[tuple[Outcome, float]]:
    """Outcomes that stand for all that an action can return, each with its probability."""
    sensor = belief.network.action(action).sensor
    table = outcome_table(belief, action)
    joint = belief.categorical(table.names[:-1]).values
    p = joint.ravel() @ table.values.reshape(joint.size, -1)
    if isinstance(sensor, ConfusionSensor):
        outcomes: list[Outcome] = [Label(label) for label in sensor.outcomes]
    else:
        group = belief.groups[belief.parts.home[sensor.property]]
        nodes = group.next_reading(sensor, belief.outcomes_of(action)).channel.readings.nodes
        outcomes = [Reading(float(y)) for y in nodes]
        outcomes += [Below(sensor.low)] if np.isfinite(sensor.low) else []
        outcomes += [Above(sensor.high)] if np.isfinite(sensor.high) else []
    return list(zip(outcomes, (p / p.sum()).tolist(), strict=True))
