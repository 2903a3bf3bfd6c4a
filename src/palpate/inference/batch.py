"""Updates and gains for many beliefs over one network at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.inference.belief import Objective, Observation
from palpate.inference.channels import OUTCOME
from palpate.inference.exact import ExactBelief
from palpate.inference.first_readings import first_readings
from palpate.inference.readings import GroupBelief
from palpate.inference.tables import noise_nats, outcome_table
from palpate.inference.tensors import Table, product
from palpate.information import p_log_p
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Below, Failed, Label, Reading

__all__ = ["gains", "updated"]

Array = NDArray[np.float64]
LN2 = float(np.log(2))
BELIEF = "(belief)"


def updated(beliefs: Sequence[ExactBelief], seen: Sequence[Observation]) -> list[ExactBelief]:
    """Each belief after one more outcome: what `ExactBelief.update` gives, to 1e-9.

    Parameters
    ----------
    seen
        The outcome of each belief, admitted.

    Raises
    ------
    ImpossibleEvidenceError
        If a belief gives its outcome probability zero.
    """
    firsts = _firsts(beliefs, seen)
    drafts: dict[int, ExactBelief] = {}
    for i, (belief, new) in enumerate(zip(beliefs, seen, strict=True)):
        if i in firsts or isinstance(new.outcome, Label | Failed):
            drafts[i] = belief.unsettled(new.action, new.outcome, firsts.get(i))
    _settle(list(drafts.values()))
    alone = zip(beliefs, seen, strict=True)
    return [drafts[i] if i in drafts else b.update(new.action, new.outcome) for i, (b, new) in enumerate(alone)]


def _firsts(beliefs: Sequence[ExactBelief], seen: Sequence[Observation]) -> dict[int, GroupBelief]:
    """The measured groups of beliefs that have seen nothing of them so far, where they can be had together."""
    found: dict[int, GroupBelief] = {}
    alike: dict[tuple[str, Above | Below], GroupBelief] = {}
    plain: dict[str, dict[int, Reading]] = {}
    for i, (belief, new) in enumerate(zip(beliefs, seen, strict=True)):
        sensor = belief.network.actions[new.action].sensor
        if not isinstance(sensor, NumberSensor) or isinstance(new.outcome, Failed):
            continue
        home = belief.groups[belief.parts.home[sensor.property]]
        if home.touched:
            continue
        if isinstance(new.outcome, Above | Below):  # mostly of the few bounds at which sensors saturate
            key = new.action, new.outcome
            if key not in alike:
                alike[key] = GroupBelief(home.group, {sensor.property: [(sensor, [new.outcome])]})
            found[i] = alike[key]
        elif isinstance(new.outcome, Reading) and new.outcome.sd is None:
            plain.setdefault(new.action, {})[i] = new.outcome
    for action, rows in plain.items():
        read = first_readings([beliefs[i] for i in rows], action, list(rows.values()))
        found.update({i: home for i, home in zip(rows, read, strict=True) if home is not None})
    return found


def _settle(beliefs: Sequence[ExactBelief]) -> None:
    """Make distributions of the log joints."""
    if not beliefs:
        return
    log_joint = np.stack([belief.log_joint for belief in beliefs])
    axes = tuple(range(1, log_joint.ndim))
    peak = log_joint.max(axis=axes, keepdims=True)
    if np.isneginf(peak).any():
        for belief in beliefs:
            belief.normalise()  # says which outcome is impossible
    joint = np.exp(log_joint - peak)
    total = joint.sum(axis=axes, keepdims=True)
    log_evidence = (peak + np.log(total)).ravel().tolist()
    for belief, own, log_total in zip(beliefs, joint / total, log_evidence, strict=True):
        belief.settle(own, log_total)


def gains(
    beliefs: Sequence[ExactBelief], objective: Objective, options: Sequence[Sequence[str]]
) -> list[dict[str, float]]:
    """Expected gains [bits] of each belief's options about an objective, to 1e-9 of those of the beliefs alone."""
    network, parts = beliefs[0].network, beliefs[0].parts
    target = parts.target(network, objective)
    found: list[dict[str, float]] = [{} for _ in beliefs]
    for name, action in network.actions.items():
        rows = [i for i, own in enumerate(options) if name in own]
        some = [beliefs[i] for i in rows]
        if not some:
            continue
        if action.sensor.property in target.fixed:
            bits = _told(some, name)
        elif not (target.partial or target.whole):
            bits = _about_states(some, target.categorical, name)
        else:
            bits = [belief.expected_gains([objective], [name])[name][objective] or 0.0 for belief in some]
        for i, gain in zip(rows, bits, strict=True):
            found[i][name] = gain
    return found


def _by_table(beliefs: Sequence[ExactBelief], action: str) -> Iterator[tuple[list[int], Table]]:
    """The tables of an action's outcomes given the configuration, and the beliefs that share them."""
    sensor = beliefs[0].network.actions[action].sensor
    if isinstance(sensor, ConfusionSensor) and not sensor.repeat_probability:
        yield list(range(len(beliefs))), outcome_table(beliefs[0], action)
        return
    shared: dict[int, tuple[list[int], Table]] = {}
    for i, belief in enumerate(beliefs):
        table = outcome_table(belief, action)
        shared.setdefault(id(table.values), ([], table))[0].append(i)
    yield from shared.values()


def _told(beliefs: Sequence[ExactBelief], action: str) -> list[float]:
    """I(measured property; outcome), and of anything that fixes the property [bits]."""
    nats = np.empty(len(beliefs))
    for rows, table in _by_table(beliefs, action):
        weights = np.stack([beliefs[i].categorical(table.names[:-1]).values.ravel() for i in rows])
        p = weights @ table.values.reshape(weights.shape[1], -1)
        nats[rows] = -p_log_p(p).sum(axis=1) - weights @ noise_nats(beliefs[rows[0]], action)
    return _bits(nats)


def _about_states(beliefs: Sequence[ExactBelief], properties: Sequence[str], action: str) -> list[float]:
    """I(categorical properties together; outcome) [bits]."""
    axes, nats = beliefs[0].parts.axes, np.empty(len(beliefs))
    for rows, table in _by_table(beliefs, action):
        joints = np.stack([beliefs[i].joint.values for i in rows])
        nats[rows] = _gains(joints, axes, tuple(properties), table.names[:-1], table.values)
    return _bits(nats)


def _bits(nats: Array) -> list[float]:
    found: list[float] = (np.maximum(nats, 0.0) / LN2).tolist()
    return found


def _gains(
    joints: Array, axes: tuple[str, ...], properties: tuple[str, ...], own: tuple[str, ...], table: Array
) -> Array:
    """I(properties; outcome) of each joint table in the stack (B,) [nats]."""
    names = tuple(n for n in axes if n in properties or n in own)
    drop = tuple(i + 1 for i, n in enumerate(axes) if n not in names)
    kept = Table(joints.sum(axis=drop) if drop else joints, (BELIEF, *names))
    joint = product(kept, Table(table, (*own, OUTCOME)), (BELIEF, *properties, OUTCOME)).values
    joint = joint.reshape(len(joints), -1, table.shape[-1])
    outcome, states, total = joint.sum(axis=1), joint.sum(axis=2), joint.sum(axis=(1, 2))
    nats = p_log_p(joint).sum(axis=(1, 2)) - p_log_p(outcome).sum(axis=1) - p_log_p(states).sum(axis=1)
    return np.asarray(nats + p_log_p(total))
