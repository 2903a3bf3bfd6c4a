"""A group of continuous properties given the readings of its members."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from math import prod

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError
from palpate.inference.chart import Chart, Frame
from palpate.inference.group import Group
from palpate.inference.mesh import Mesh
from palpate.inference.next_reading import NextReading
from palpate.inference.tensors import Table, contract
from palpate.inference.window import EDGE_MASS, EDGE_NODES, FAINT, Readings, Window, crowding, cut, resolve
from palpate.network.sensors import NumberOutcome, NumberSensor

__all__ = ["GroupBelief"]

Array = NDArray[np.float64]
Names = tuple[str, ...]

TINY = 1e-290
RESOLVED, UNRESOLVED = 1e-4, 0.25
"""Relative change of a configuration's mass at which halving panels stops, and at which it has failed."""
FAR = 1000.0
"""Ranges of all that is believed beyond which a reading is an error, not a surprise."""
ALL = slice(None)
MAX_ENTRIES = 4_000_000
"""Entries of a chart's largest table beyond which it is not refined further."""


class GroupBelief:
    """Densities of a group over its charts, kept once worked out.

    Parameters
    ----------
    readings
        Property to its readings, per action the sensor and the outcomes.
    log_evidence
        What the property of that name would work out, where it is known already.
    """

    def __init__(self, group: Group, readings: Mapping[str, Readings], log_evidence: Table | None = None) -> None:
        self.group = group
        self.readings = readings
        self.touched = frozenset(readings)
        self._log_evidence = log_evidence

    # What is worked out is kept: in dictionaries made when first asked for, as most beliefs of many are never asked.

    @cached_property
    def _windows(self) -> dict[str, Window]:
        return {}

    @cached_property
    def _charts(self) -> dict[Names, Chart]:
        return {}

    @cached_property
    def _masses(self) -> dict[tuple[Names, Names], Table]:
        return {}

    @cached_property
    def _next(self) -> dict[tuple[int, tuple[NumberOutcome, ...]], NextReading]:
        return {}

    def _look(self) -> None:
        """Find the windows of all readings, wide enough to hold what counts."""
        self._windows = {name: Window.of(r) for name, r in self.readings.items()}
        for name in sorted(self.touched):
            self._check_reach(name)
        for name in sorted(self.touched & self.group.derived.keys()):
            self._settle(name)

    def frame(self, *required: str) -> Frame | None:
        """The choice of axes for the required members."""
        return self.group.frame(required, self.touched)

    def sure_frame(self, *required: str) -> Frame:
        """The same where reading the network, or taking an objective apart, made sure that there is one."""
        frame = self.frame(*required)
        assert frame is not None, f"no chart has the axes {required}"
        return frame

    def chart(self, frame: Frame) -> Chart:
        """The chart over some axes."""
        if not self._windows and self.touched:
            self._look()
        if frame.axes not in self._charts:
            self._charts[frame.axes] = self._made(frame)
            while self.touched and (longer := self._longer(frame)):
                self._charts[frame.axes] = self._fresh(frame, {**self._charts[frame.axes].meshes, **longer})
                self._masses = {key: mass for key, mass in self._masses.items() if key[0] != frame.axes}
        return self._charts[frame.axes]

    def reduced(self, frame: Frame, *axes: str) -> tuple[Table, ...]:
        """Tables whose product, summed to configurations and some of the chart's axes, is their mass.

        The last axis is summed out where it is not asked for, once for all that ask.
        """
        if self._in_one(frame, axes):
            return (self.mass(frame, *axes),)
        chart = self.chart(frame)
        return chart.factors if frame.axes[-1] in axes else chart.reduced

    def _in_one(self, frame: Frame, axes: Names) -> bool:
        """Whether the mass is best kept as one table: it has no more numbers, or beliefs without readings share it."""
        known = len(frame.axes) == 1 or not self.touched or self.chart(frame).totals is not None
        return axes == frame.axes[-1:] and known

    def mass(self, frame: Frame, *axes: str) -> Table:
        """The chart's total per configuration, and per node of the given axes."""
        key = (frame.axes, axes)
        if key not in self._masses:
            chart, last = self.chart(frame), frame.axes[-1:]
            own = (*self.group.parents, *axes)
            if chart.totals is not None and not axes:
                self._masses[key] = self.mass(frame, *last).sum_to(own)
            elif chart.totals is not None and axes == last:
                self._masses[key] = contract((chart.totals, chart.along), own)
            else:
                tables = chart.factors if set(last) & set(axes) or len(frame.axes) == 1 else chart.reduced
                self._masses[key] = contract(tables, own)
        return self._masses[key]

    @property
    def log_evidence(self) -> Table:
        """Natural log of p(readings | configuration); -inf where it is zero."""
        if self._log_evidence is None:
            frame = self.sure_frame()
            with np.errstate(divide="ignore"):
                values = np.log(self.mass(frame).values) + self.chart(frame).log_scale
            self._log_evidence = Table(values, self.group.parents)
        return self._log_evidence

    def next_reading(self, sensor: NumberSensor, past: Sequence[NumberOutcome]) -> NextReading:
        """What a sensor of a member will return after its past readings."""
        # Past readings of the sensor change its next one only through an offset that they share.
        key = (id(sensor), tuple(past) if sensor.offset_sd else ())
        if key not in self._next:
            self._next[key] = NextReading(self, sensor, past)
        return self._next[key]

    def values(self, frame: Frame, name: str) -> Array:
        """Values of a member at all nodes of a chart."""
        meshes = self.chart(frame).meshes
        solved, _ = frame.values(frame.tensor(meshes))
        x = solved[name] if name in solved else self.group.derived[name].formula.evaluate(solved)
        return np.broadcast_to(x, tuple(meshes[axis].size for axis in frame.axes))

    def log_likelihood(self, name: str, x: Array) -> Array:
        """Natural log of p(readings of the member | its value x), any shape."""
        flat = np.ravel(x)
        first, *more = (sensor.log_likelihood(outcomes, flat) for sensor, outcomes in self.readings[name])
        total = sum(more, first)
        # Where a formula cannot be solved there is nothing, whatever was read.
        return np.where(np.isnan(total), -np.inf, total).reshape(np.shape(x))

    def _mesh(self, frame: Frame, name: str) -> Mesh:
        prior = self.group.mesh(frame, name)
        if name not in self.touched:
            return self._beside_evidence(frame, name, prior)
        return resolve(prior, self._windows[name], self.group.support(name), whole=name in self.group.bases)

    def _beside_evidence(self, frame: Frame, name: str, prior: Mesh) -> Mesh:
        """The mesh of an axis cut so that it resolves what evidence on a derived axis makes of it."""
        # The scale at the lower edge, but for the panel that begins at the end of the support.
        points = np.append((prior.edges[0] + prior.edges[1]) / 2, prior.edges[1:-1])
        for axis, solved in frame.order:
            if axis in self.touched and name in self.group.derived[axis].formula.variables:
                sharpest = min((fine[2] for fine in self._windows[axis].fine), default=np.inf)
                scale = self.group.scale_given(axis, solved, name, partial(np.full_like, fill_value=sharpest))
                middles = (prior.edges[1:] + prior.edges[:-1]) / 2
                lengths = np.minimum(scale(points), scale(middles))
                return cut(prior, self.group.read_finely(name, middles, lengths))
        return prior

    def _made(self, frame: Frame) -> Chart:
        last = frame.axes[-1]
        if not self.touched:
            return frame.prior(self.group.meshes(frame))
        if self.touched == {last} and (last in self.group.derived or len(frame.axes) == 1):
            known = self.group.window_chart if last in self.group.derived else self.group.whole_chart
            chart = known(frame, self._windows[last])
            if chart is not None:
                return chart.with_likelihood(self.log_likelihood(last, chart.meshes[last].nodes))
        chart = self._fresh(frame, {name: self._mesh(frame, name) for name in frame.axes})
        return self._refined(frame, chart) if self.touched - set(frame.axes) else chart

    def _longer(self, frame: Frame) -> dict[str, Mesh]:
        """Meshes that reach further, of axes without evidence that end where conflicting evidence pushes."""
        chart = self._charts[frame.axes]
        grown: dict[str, Mesh] = {}
        if chart.tables[-1].values.size > MAX_ENTRIES / 4:
            return grown
        for name in (n for n in frame.axes if n not in self.touched and len(frame.axes) > 1):
            mesh, (low, high) = chart.meshes[name], self.group.support(name)
            above = mesh.edges[-1] < high and self._held(frame, name, slice(-EDGE_NODES, None))
            if above or (mesh.edges[0] > low and self._held(frame, name, slice(EDGE_NODES))):
                grown[name] = mesh.longer(low, high)
        return grown

    def _held(self, frame: Frame, name: str, end: slice) -> bool:
        """Whether a configuration that counts has mass at an end of an axis."""
        chart = self._charts[frame.axes]
        tables = chart.factors if name == frame.axes[-1] else chart.reduced
        cut = [Table(t.values[tuple(end if n == name else ALL for n in t.names)], t.names) for t in tables]
        total = self.mass(frame).values
        most, least = total.max(), EDGE_MASS * FAINT
        if prod(float(t.values.max()) for t in cut) * EDGE_NODES < least * most:
            return False  # no configuration can: the common case, found without their tables
        mass = contract(cut, self.group.parents).values
        return bool((mass > crowding(total, most)).any())

    def _check_reach(self, name: str) -> None:
        """Refuse readings so far from all that is believed that resolving them makes no sense."""
        mesh = self.group.mesh(self.sure_frame(name), name)
        far = FAR * float(mesh.edges[-1] - mesh.edges[0])
        window = self._windows[name]
        if window.low > mesh.edges[-1] + far or window.high < mesh.edges[0] - far:
            raise EvidenceError(
                f"a reading of {name} lies more than {FAR:g} times as far out as anything the network believes: "
                "check its unit and the sensor"
            )

    def _fresh(self, frame: Frame, meshes: Mapping[str, Mesh]) -> Chart:
        values, _ = frame.values(frame.tensor(meshes))
        total = np.zeros((1,) * len(frame.axes))
        for name in sorted(self.touched):
            x = values[name] if name in values else self.group.derived[name].formula.evaluate(values)
            total = total + self.log_likelihood(name, x)
        return frame.chart(meshes, total)

    def _refined(self, frame: Frame, chart: Chart) -> Chart:
        """The chart with its panels halved until evidence on members that are not axes is resolved.

        Raises
        ------
        EvidenceError
            If that takes more numbers than is sensible, and what there is still changes by a quarter.
        """
        parents, error = self.group.parents, 0.0
        while chart.tables[-1].values.size * 2 ** len(frame.axes) < MAX_ENTRIES:
            finer = self._fresh(frame, {name: mesh.halved() for name, mesh in chart.meshes.items()})
            old = contract(chart.factors, parents).values * np.exp(chart.log_scale - finer.log_scale)
            new = contract(finer.factors, parents).values
            chart, error = finer, float(np.max(np.abs(new - old) / (new + 0.01 * new.max() + TINY)))
            if error <= RESOLVED:
                return chart
        if error > UNRESOLVED:
            sharp = ", ".join(sorted(self.touched))
            raise EvidenceError(
                f"the readings of {sharp} are too sharp beside each other to be worked out exactly: "
                "give them a larger sd, or measure one of them only"
            )
        return chart

    def _settle(self, name: str) -> None:
        """Widen the window of a derived member until no configuration has mass at its ends."""
        frame = self.sure_frame()
        while name in frame.axes:
            at_low, at_high = self._crowded(frame, name)
            if not at_low and not at_high:
                break
            self._windows[name] = self._windows[name].wider(at_low, at_high)
            self._charts.clear()
            self._masses.clear()

    def _crowded(self, frame: Frame, name: str) -> tuple[bool, bool]:
        mesh, prior = self.chart(frame).meshes[name], self.group.mesh(frame, name)
        low_open = mesh.edges[0] > max(self.group.support(name)[0], prior.edges[0])
        high_open = mesh.edges[-1] < prior.edges[-1]
        masses = self.mass(frame, name).values.reshape(-1, mesh.size)
        total = masses.sum(axis=1)
        faint = crowding(total, total.max())
        at_low, at_high = masses[:, :EDGE_NODES].sum(axis=1), masses[:, -EDGE_NODES:].sum(axis=1)
        return bool(low_open and (at_low > faint).any()), bool(high_open and (at_high > faint).any())
