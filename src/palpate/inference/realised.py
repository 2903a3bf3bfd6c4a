"""Realised information gain: how far one outcome moved the belief."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError
from palpate.inference.belief import Objective, Observation
from palpate.inference.targets import Target
from palpate.inference.tensors import Table, contract
from palpate.inference.view import View
from palpate.information import kl_bits
from palpate.network.admission import StateLikelihood
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Failed, Label

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["realised_gain"]

Array = NDArray[np.float64]


def realised_gain(before: ExactBelief, after: ExactBelief, objective: Objective) -> float:
    """KL(after || before) of the objective [bits].

    With p(z | y) / p(z) = p(y | z) / p(y), where the objective fixes the measured property this is
    the mean log likelihood under the belief after, less the log predictive probability.

    Raises
    ------
    EvidenceError
        If `after` is not `before` and exactly one more outcome.
    """
    if len(after.evidence) != len(before.evidence) + 1:
        found = len(after.evidence) - len(before.evidence)
        raise EvidenceError(f"realised gain: the beliefs are {found} outcomes apart, expected one")
    seen = after.evidence[-1]
    if isinstance(seen.outcome, Failed):
        return 0.0
    measured = before.network.actions[seen.action].sensor.property
    target = before.parts.target(before.network, objective)
    if measured in target.fixed:
        return max(0.0, _mean_log_likelihood(before, after, seen, measured) / float(np.log(2)))
    home = before.parts.home.get(measured)
    if home is None or not set(target.members(before.groups)) & set(before.groups[home].group.members):
        return _direct(before, after, target)
    return _reweighted(before, after, measured, target)


def _mean_log_likelihood(before: ExactBelief, after: ExactBelief, seen: Observation, measured: str) -> float:
    """Mean under `after` of ln p(y | measured property), less ln p(y) [nats]."""
    if measured in before.parts.home:
        masses, nodes = after.masses(measured), after.mesh(measured).nodes
        log_p = _log_likelihood(before, after, measured, nodes)
    else:
        masses = after.categorical((measured,)).values
        log_p = np.log(np.maximum(_vector(before, seen), np.finfo(float).tiny))
    return float(masses @ np.where(masses > 0, log_p, 0.0)) - (after.log_evidence - before.log_evidence)


def _vector(before: ExactBelief, seen: Observation) -> Array:
    """Likelihood of the last outcome for each state."""
    if isinstance(seen.outcome, Label):
        sensor = before.network.actions[seen.action].sensor
        assert isinstance(sensor, ConfusionSensor)
        table = sensor.predictive(before.labels_of(seen.action))
        return np.asarray(table[sensor.outcomes.index(seen.outcome.label)])
    assert isinstance(seen.outcome, StateLikelihood)
    return seen.outcome.values


def _log_likelihood(before: ExactBelief, after: ExactBelief, measured: str, x: Array) -> Array:
    """ln p(last reading | value x, readings before) (X,)."""
    home = before.parts.home[measured]
    total = after.groups[home].log_likelihood(measured, x)
    if measured in before.groups[home].touched:
        total = total - before.groups[home].log_likelihood(measured, x)
    return total


def _direct(before: ExactBelief, after: ExactBelief, target: Target) -> float:
    """The tables of both beliefs compared: the outcome left the meshes as they were."""
    members = target.members(before.groups)
    new, old = (View(belief, whole=True).joint(members, target.categorical).values for belief in (after, before))
    return kl_bits(new, old)


def _reweighted(before: ExactBelief, after: ExactBelief, measured: str, target: Target) -> float:
    """The same in the measured property's own group, whose mesh the outcome changed: on the old mesh."""
    members = target.members(before.groups)
    home = before.groups[before.parts.home[measured]]
    own = tuple(m for m in members if m in home.group.members)
    frame = home.frame(*own, measured)
    if frame is None:
        return _over_chart(before, after, measured, target, members)
    joint = View(before, whole=True).joint((*members, measured), target.categorical).values
    mesh = home.chart(frame).meshes[measured]
    sensor = before.network.actions[after.evidence[-1].action].sensor
    assert not isinstance(sensor, ConfusionSensor)
    # Scaled by its peak under the belief after, near which all that counts lies.
    peak = float(_log_likelihood(before, after, measured, after.mesh(measured).nodes).max())
    finer = mesh.finer(sensor.scale(mesh.nodes, getattr(after.evidence[-1].outcome, "sd", None)))
    if finer is None:
        likelihood = np.exp(_log_likelihood(before, after, measured, mesh.nodes) - peak)
    else:
        likelihood = finer.averaged(lambda x: np.exp(_log_likelihood(before, after, measured, x) - peak), mesh.size)[
            :, 0
        ]
    new = np.maximum(joint @ likelihood, 0.0)
    return kl_bits(new / new.sum(), joint.sum(axis=-1))


def _over_chart(
    before: ExactBelief, after: ExactBelief, measured: str, target: Target, members: tuple[str, ...]
) -> float:
    """The same where the measured property is no axis beside the members: over all of the group's chart."""
    home = before.groups[before.parts.home[measured]]
    frame = home.sure_frame(*(m for m in members if m in home.group.members))
    axes = (*frame.axes, *(m for m in members if m not in frame.axes))
    joint = View(before, whole=True).joint(axes, target.categorical)
    log_p = _log_likelihood(before, after, measured, home.values(frame, measured))
    values = Table(np.exp(log_p - log_p.max()), frame.axes)
    out = (*target.categorical, *members)
    new = contract((joint, values), out).values
    return kl_bits(new / new.sum(), joint.sum_to(out).values)
