"""First readings of a group for many beliefs at once.

As long as nothing of a group was measured, a reading's evidence per configuration is one product of
the reading's likelihood along the measured property and the group's own tables: beliefs share these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.inference.axes import ALONE
from palpate.inference.chart import Chart, Frame
from palpate.inference.group import MASTER_LEVELS, Group
from palpate.inference.mesh import ORDER, WIDTH, Mesh
from palpate.inference.readings import GroupBelief
from palpate.inference.tensors import Table
from palpate.inference.window import REACH, SLACK
from palpate.information import TINY
from palpate.network.sensors import NormalNoise, NumberSensor
from palpate.outcomes import Reading

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["first_readings"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Flags = NDArray[np.bool_]

EDGE_NODES = 2
LOST = 1e-10
"""Share of a belief that may lie at the ends of its window."""
PLAIN = 1e-6
"""Probability of a reading, to within its noise, below which meshes may have to reach further."""
ROWS = 32
"""Readings, near each other, that are worked out together."""


def first_readings(
    beliefs: Sequence[ExactBelief], action: str, readings: Sequence[Reading]
) -> list[GroupBelief | None]:
    """The measured group of each belief given its first reading, whose evidence is worked out already.

    None stands for a reading that the belief must use alone, as it is surprising or asks for a
    mesh of its own.
    """
    sensor = beliefs[0].network.actions[action].sensor
    assert isinstance(sensor, NumberSensor)
    group = beliefs[0].groups[beliefs[0].parts.home[sensor.property]].group
    weights = np.stack([belief.categorical(group.parents).values for belief in beliefs])
    values = np.array([reading.value for reading in readings])
    log_evidence, done = _log_evidence(group, sensor, values, weights.reshape(len(values), -1))
    return [
        GroupBelief(group, {sensor.property: [(sensor, [reading])]}, Table(row, group.parents)) if fine else None
        for reading, row, fine in zip(readings, log_evidence.reshape(weights.shape), done.tolist(), strict=True)
    ]


def _log_evidence(group: Group, sensor: NumberSensor, values: Array, weights: Array) -> tuple[Array, Flags]:
    """Natural log of p(reading | configuration) (B, configurations), and the rows that are exact (B,).

    Parameters
    ----------
    values
        Readings [unit of the property] (B,).
    weights
        Probabilities of the group's configurations before (B, configurations).
    """
    log_evidence = np.full(weights.shape, -np.inf)
    done = np.zeros(len(values), dtype=bool)
    frame = group.frame((), frozenset({sensor.property}))
    plain = isinstance(sensor.noise, NormalNoise) and not sensor.relative_sd
    if frame is None or frame.axes[-1] != sensor.property or not plain:
        return log_evidence, done
    for rows, chart, ends in _charts(group, frame, sensor, values):
        log_evidence[rows], done[rows] = _worked_out(chart, sensor, values[rows], weights[rows], ends)
    return log_evidence, done


def _charts(
    group: Group, frame: Frame, sensor: NumberSensor, values: Array
) -> Iterator[tuple[Index, Chart, list[Index]]]:
    """Charts that hold the likelihood of some readings: their rows, the chart, and where each is cut off in it."""
    scale = float(np.hypot(sensor.sd, sensor.offset_sd))
    order = np.argsort(values)
    if len(frame.axes) == 1:
        *_, held = _panels(group.master_mesh(frame, 0), values, scale, ALONE)
        if held.any():
            yield order[held[order]], group.whole(frame), []
        return
    left = np.ones(len(values), dtype=bool)
    for level in range(MASTER_LEVELS):
        first, last, held = _panels(group.master_mesh(frame, level), values, scale, 1.0)
        rows = order[(held & left)[order]]
        left &= ~held
        for some in np.split(rows, range(ROWS, len(rows), ROWS)):
            if len(some):
                start, stop = int(first[some].min()), int(last[some].max())
                chart = group.master(frame, level).window(start, stop)
                lows, highs = (first[some] - start) * ORDER, (last[some] - start) * ORDER - 1
                yield some, chart, [n for k in range(EDGE_NODES) for n in (lows + k, highs - k)]


def _panels(mesh: Mesh, values: Array, scale: float, share: float) -> tuple[Index, Index, Flags]:
    """First panel and end of the panels that hold each reading's likelihood, and whether they resolve it."""
    low, high = values - REACH * scale, values + REACH * scale
    first = np.searchsorted(mesh.edges, low, "right") - 1
    last = np.searchsorted(mesh.edges, high)
    end = len(mesh.edges) - 1
    if mesh.graded[0]:
        first = np.maximum(first, 0)
    held = (first >= 0) & (first < last) & (last <= end)
    wide = np.append(0, np.cumsum(np.diff(mesh.edges) > SLACK * WIDTH * share * scale))
    return first, last, held & (wide[np.minimum(last, end)] == wide[np.maximum(first, 0)])


def _worked_out(
    chart: Chart, sensor: NumberSensor, values: Array, weights: Array, ends: Sequence[Index]
) -> tuple[Array, Flags]:
    """Log evidence of readings on one chart, and which are exact: those that leave nothing where they are cut off."""
    *_, last = chart.meshes
    nodes = chart.meshes[last].nodes
    totals = chart.totals or chart.tables[0]
    own = totals.sum_to((last, *(n for n in totals.names if n != last))).values.reshape(len(nodes), -1)
    likelihood = sensor.predictive((), nodes).density(values).T * chart.along.values
    evidence = likelihood @ own
    joint = weights * evidence
    total = np.maximum(joint.sum(axis=1), TINY)
    rows, lost = np.arange(len(values)), np.zeros(len(values))
    for node in ends:
        lost += likelihood[rows, node] * (weights * own[node]).sum(axis=1)
    scale = float(np.hypot(sensor.sd, sensor.offset_sd))
    with np.errstate(divide="ignore"):
        log_evidence = np.log(evidence) + chart.log_scale
    return log_evidence, (lost < LOST * total) & (total * np.exp(chart.log_scale) * scale > PLAIN)
