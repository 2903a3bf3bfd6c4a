"""First readings of a group for many beliefs at once.

As long as nothing of a group was measured, a reading's evidence per configuration is one product of
the reading's likelihood along the measured property and the group's own tables: beliefs share these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.inference.axes import ALONE
from palpate.inference.chart import Chart, Frame
from palpate.inference.group import MASTER_LEVELS, Group
from palpate.inference.mesh import ORDER, WIDTH, Mesh
from palpate.inference.readings import GroupBelief
from palpate.inference.tensors import Table
from palpate.inference.window import EDGE_NODES, REACH, SLACK, crowding
from palpate.network.noises import NormalNoise
from palpate.network.sensors import NumberSensor
from palpate.outcomes import Reading

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["first_readings"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Flags = NDArray[np.bool_]

PLAIN = 3e-3
"""Density of a reading, times the noise, in the best configuration, below which meshes may have to reach further."""
ROWS = 32
"""Readings, near each other, that are worked out together."""


@dataclass(frozen=True)
class _Windows:
    """First node and end of the window of each reading, and whether the mesh goes on there."""

    first: Index
    stop: Index
    low_open: Flags
    high_open: Flags

    def cut(self, likelihood: Array) -> None:
        """Leave nothing of the likelihood (B, nodes) outside the windows."""
        place = np.arange(likelihood.shape[1])
        likelihood[(place < self.first[:, None]) | (place >= self.stop[:, None])] = 0.0

    def crowded(self, likelihood: Array, own: Array, faint: Array) -> Flags:
        """Which readings leave a configuration more than `faint` (B, configurations) at an open end."""
        rows, found = np.arange(len(likelihood)), np.zeros(len(likelihood), dtype=bool)
        for place, step, goes_on in ((self.first, 1, self.low_open), (self.stop - 1, -1, self.high_open)):
            ends = [place + step * k for k in range(EDGE_NODES)]
            mass = sum(likelihood[rows, node][:, None] * own[node] for node in ends)
            found |= goes_on & (mass > faint).any(axis=1)
        return found


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
    shape = beliefs[0].categorical(group.parents).values.shape
    values = np.array([reading.value for reading in readings])
    log_evidence, done = _log_evidence(group, sensor, values, prod(shape))
    return [
        GroupBelief(group, {sensor.property: [(sensor, [reading])]}, Table(row, group.parents)) if fine else None
        for reading, row, fine in zip(readings, log_evidence.reshape(len(values), *shape), done.tolist(), strict=True)
    ]


def _log_evidence(group: Group, sensor: NumberSensor, values: Array, cells: int) -> tuple[Array, Flags]:
    """Natural log of p(reading | configuration) (B, configurations), and the rows that are exact (B,)."""
    log_evidence = np.full((len(values), cells), -np.inf)
    done = np.zeros(len(values), dtype=bool)
    frame = group.frame((), frozenset({sensor.property}))
    plain = isinstance(sensor.noise, NormalNoise) and not sensor.relative_sd
    if frame is None or frame.axes[-1] != sensor.property or not plain:
        return log_evidence, done
    for rows, chart, windows in _charts(group, frame, sensor, values):
        log_evidence[rows], done[rows] = _worked_out(chart, sensor, values[rows], windows)
    return log_evidence, done


def _charts(
    group: Group, frame: Frame, sensor: NumberSensor, values: Array
) -> Iterator[tuple[Index, Chart, _Windows | None]]:
    """Charts that hold the likelihood of some readings: their rows, the chart, and each one's window in it."""
    scale = float(np.hypot(sensor.sd, sensor.offset_sd))
    order, about = np.argsort(values), values - sensor.bias
    if len(frame.axes) == 1:
        *_, held = _panels(group.master_mesh(frame, 0), about, scale, ALONE)
        if held.any():
            yield order[held[order]], group.whole(frame), None
        return
    left = np.ones(len(values), dtype=bool)
    for level in range(MASTER_LEVELS):
        mesh = group.master_mesh(frame, level)
        end = len(mesh.edges) - 1
        first, last, held = _panels(mesh, about, scale, 1.0)
        rows = order[(held & left)[order]]
        left &= ~held
        for some in np.split(rows, range(ROWS, len(rows), ROWS)):
            if len(some):
                start, stop = int(first[some].min()), int(last[some].max())
                chart = group.master(frame, level).window(start, stop)
                windows = _Windows(
                    (first[some] - start) * ORDER, (last[some] - start) * ORDER, first[some] > 0, last[some] < end
                )
                yield some, chart, windows


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


def _worked_out(chart: Chart, sensor: NumberSensor, values: Array, windows: _Windows | None) -> tuple[Array, Flags]:
    """Log evidence of readings on one chart, and which are exact: those whose window no configuration crowds."""
    *_, last = chart.meshes
    nodes = chart.meshes[last].nodes
    totals = chart.totals or chart.tables[0]
    own = totals.sum_to((last, *(n for n in totals.names if n != last))).values.reshape(len(nodes), -1)
    likelihood = sensor.predictive((), nodes).density(values).T * chart.along.values
    if windows is not None:
        windows.cut(likelihood)
    evidence = likelihood @ own
    most = evidence.max(axis=1, keepdims=True)
    scale = float(np.hypot(sensor.sd, sensor.offset_sd))
    done = most[:, 0] * np.exp(chart.log_scale) * scale > PLAIN
    if windows is not None:
        done &= ~windows.crowded(likelihood, own, crowding(evidence, most))
    with np.errstate(divide="ignore"):
        return np.log(evidence) + chart.log_scale, done
