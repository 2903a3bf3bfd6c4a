"""Expected information gain: the mutual information of an action's outcome and an objective.

I(Z; Y) = H(Y) - H(Y | Z) in bits, for any set Z of properties. Where Z fixes the property that the
action measures, H(Y | Z) is the mean entropy of the sensor's noise; else the joint of Z and Y
follows from the belief's tables and the action's channel. All objectives share the tables: their
states and nodes are rows of one matrix, of which every channel makes a joint with its outcomes.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.inference.belief import Gains, Objective
from palpate.inference.channels import OUTCOME
from palpate.inference.rows import Rows, stacked
from palpate.inference.targets import Target
from palpate.inference.tensors import Table
from palpate.inference.view import View
from palpate.information import TINY, sum_p_log_p
from palpate.network.sensors import ConfusionSensor, NumberSensor

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["expected_gains"]

Array = NDArray[np.float64]
LN2 = float(np.log(2))
MAX_STACKED = 200_000
"""Entries of the shared rows beyond which each channel gets rows of its own."""


def expected_gains(belief: ExactBelief, objectives: Sequence[Objective], actions: Sequence[str]) -> Gains:
    """Expected gain of every action about every objective [bits]."""
    targets = [belief.parts.target(belief.network, objective) for objective in objectives]
    view = View(belief)
    nats = {name: _Answer(view, name, targets) for name in actions}
    _through_configurations(view, list(nats.values()))
    return {
        name: dict(zip(objectives, (np.maximum(answer.nats, 0.0) / LN2).tolist(), strict=True))
        for name, answer in nats.items()
    }


class _Answer:
    """The gains of one action about all objectives, filled in as they are worked out [nats].

    Attributes
    ----------
    parents
        The categorical properties through which objectives elsewhere know of the outcome.
    table
        p(outcome | configuration of the parents) (configurations, outcomes).
    before
        -sum p ln p of the outcome [nats].
    """

    def __init__(self, view: View, action: str, targets: Sequence[Target]) -> None:
        sensor = view.belief.network.action(action).sensor
        self.targets = targets
        self.nats = np.zeros(len(targets))
        self.open = [i for i, t in enumerate(targets) if sensor.property not in t.fixed]
        if isinstance(sensor, ConfusionSensor):
            fixed = self._labels(view, action, sensor)
        else:
            fixed = self._numbers(view, action, sensor)
        self.nats[[i for i in range(len(targets)) if i not in self.open]] = fixed
        if not isinstance(sensor, ConfusionSensor):
            self._beside(view, action, sensor)

    def _labels(self, view: View, action: str, sensor: ConfusionSensor) -> float:
        """Set up the channel of a label sensor; I(measured property; label) [nats]."""
        self.parents: tuple[str, ...] = (sensor.property,)
        predictive = sensor.predictive(view.belief.labels_of(action)).T
        self.table = view.kept(Table(predictive, (sensor.property, OUTCOME))).values
        states = view.categorical(self.parents).values
        self.before = -sum_p_log_p(states @ self.table)
        return self.before + float(states @ (self.table * np.log(np.maximum(self.table, TINY))).sum(axis=1))

    def _numbers(self, view: View, action: str, sensor: NumberSensor) -> float:
        """Set up the channel of a number sensor; I(measured property; reading) [nats]."""
        home = view.home(sensor.property)
        reading = home.next_reading(sensor, view.belief.outcomes_of(action))
        self.parents = home.group.parents
        given = view.kept(reading.given).values
        self.table = given.reshape(-1, given.shape[-1])
        weights = view.categorical(self.parents).values.ravel()
        self.before = -sum_p_log_p(weights @ self.table)
        return self.before - float(weights @ view.kept(reading.noise).values.ravel())

    def _beside(self, view: View, action: str, sensor: NumberSensor) -> None:
        """Objectives with members in the measured property's own group."""
        home = view.home(sensor.property)
        for i in [i for i in self.open if set(view.members(self.targets[i])) & set(home.group.members)]:
            reading = home.next_reading(sensor, view.belief.outcomes_of(action))
            joint = view.beside(self.targets[i], reading)
            self.nats[i] = self.before + sum_p_log_p(joint) - sum_p_log_p(joint.sum(axis=1))
            self.open.remove(i)


def _through_configurations(view: View, answers: Sequence[_Answer]) -> None:
    """The objectives that know of an outcome only through categorical properties."""
    waiting = [a for a in answers if a.open]
    if not waiting:
        return
    wanted = {i: a.targets[i] for a in waiting for i in a.open}
    names = view.ordered({p for a in waiting for p in a.parents})
    sets = (
        [names] if view.rows_size(wanted.values(), names) <= MAX_STACKED else [view.ordered(a.parents) for a in waiting]
    )
    for parents in dict.fromkeys(sets):
        rows = stacked(view, wanted, parents)
        mine = [a for a in waiting if len(sets) == 1 or view.ordered(a.parents) == parents]
        for own in dict.fromkeys(view.ordered(a.parents) for a in mine):
            _joint_nats(rows, own, [a for a in mine if view.ordered(a.parents) == own])


def _joint_nats(rows: Rows, parents: tuple[str, ...], answers: Sequence[_Answer]) -> None:
    """H(Y) - H(Y | Z) of the answers whose channels have the same parents, in one product."""
    matrix, starts = rows.over(parents, [i for a in answers for i in a.open])
    joint = matrix.T @ (answers[0].table if len(answers) == 1 else np.hstack([a.table for a in answers]))
    joint *= np.log(np.maximum(joint, TINY))
    ends = [0, *accumulate(a.table.shape[1] for a in answers)]
    minus = np.add.reduceat(np.add.reduceat(joint, ends[:-1], axis=1), list(starts.values()), axis=0)
    for column, answer in enumerate(answers):
        for i in answer.open:
            place = list(starts).index(i)
            answer.nats[i] = answer.before + minus[place, column] - rows.sum_p_log_p[i]
