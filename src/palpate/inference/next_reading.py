"""What a sensor will return next, given each configuration of a group's categorical parents."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.inference.channels import OUTCOME, NumberChannel, reading_mesh, reading_mesh_again
from palpate.inference.chart import Frame
from palpate.inference.mesh import ORDER, Mesh
from palpate.inference.tensors import Table, contract
from palpate.network.sensors import NumberOutcome, NumberSensor

if TYPE_CHECKING:
    from palpate.inference.readings import GroupBelief

__all__ = ["NextReading"]

Array = NDArray[np.float64]

TINY = 1e-290
EMPTY = 1e-9
"""Share of a configuration's mass below which the ends of an axis need no readings."""


class NextReading:
    """The next reading of a sensor of a member of a group.

    Parameters
    ----------
    past
        The sensor's readings so far; they are among the group's own.
    """

    def __init__(self, home: GroupBelief, sensor: NumberSensor, past: Sequence[NumberOutcome]) -> None:
        self.home = home
        self.sensor = sensor
        self.past = past
        self._carried: dict[tuple[str, ...], Table] = {}

    @cached_property
    def channel(self) -> NumberChannel:
        """The reading on a mesh of readings, given the true value."""
        measured = self.sensor.property
        held, own = self._filled(self.home.sure_frame(measured))
        return NumberChannel(self.sensor, self.past, held, own, self._readings(own), self.home.group.tables)

    def _readings(self, own: Mesh) -> Mesh:
        """Where readings are looked at: as finely as the noise asks for, if they fill a short stretch."""
        home, measured = self.home, self.sensor.property
        if self.past and self.sensor.offset_sd:
            return reading_mesh_again(self.sensor, self.sensor.predictive(self.past, own.nodes))
        if home.touched:
            mesh = home.group.reading_mesh(self.sensor, float(own.edges[0]), float(own.edges[-1]))
            if mesh is not None:
                return mesh
        frames = [home.frame(m, measured) for m in home.group.members if m != measured]
        beside = [self._filled(frame)[1] for frame in frames if frame is not None]
        narrow = bool(home.touched - {measured})
        return reading_mesh(self.sensor, [own, *beside], home.group.corners(measured), narrow)

    def _filled(self, frame: Frame) -> tuple[slice, Mesh]:
        """The nodes of the measured axis whose panels hold something in any configuration, and their mesh."""
        mesh = self.home.chart(frame).meshes[self.sensor.property]
        masses = self.home.mass(frame, self.sensor.property).values.reshape(-1, mesh.size)
        share = (masses / np.maximum(masses.sum(axis=1, keepdims=True), TINY)).max(axis=0)
        held = np.flatnonzero(share > EMPTY)
        first, last = int(held[0]) // ORDER, int(held[-1]) // ORDER + 1
        return slice(first * ORDER, last * ORDER), mesh.between(first, last)

    @cached_property
    def _masses(self) -> Array:
        """Mass at the nodes of the measured property that hold something (configuration..., K)."""
        measured = self.sensor.property
        return self.home.mass(self.home.sure_frame(measured), measured).values[..., self.channel.held]

    @cached_property
    def given(self) -> Table:
        """p(reading | configuration) x weights (configuration..., outcome)."""
        table = self._masses @ self.channel.table(self.channel.own)
        total = table.sum(axis=-1, keepdims=True)
        given = np.divide(table, total, out=np.zeros_like(table), where=total > TINY)
        return Table(given, (*self.home.group.parents, OUTCOME))

    @cached_property
    def noise(self) -> Table:
        """Mean entropy of the reading given the measured property, less its mesh's, per configuration [nats]."""
        readings = self.channel.readings
        of_mesh = self.given.values[..., : readings.size] @ readings.log_weights
        total = np.maximum(self._masses.sum(axis=-1), TINY)
        return Table(self._masses @ self.channel.noise_nats / total - of_mesh, self.home.group.parents)

    def through(self, frame: Frame) -> tuple[Table, ...]:
        """A chart's tables with the measured axis replaced by the outcome, where that is worth keeping.

        Without readings the group never changes, and its tables are carried through the channel once.
        """
        home, measured, tables = self.home, self.sensor.property, self.home.chart(frame).factors
        if measured not in frame.axes:
            return (*tables, Table(self.channel.at(home.values(frame, measured)), (*frame.axes, OUTCOME)))
        table = Table(self.channel.table(home.chart(frame).meshes[measured]), (measured, OUTCOME))
        if home.touched:
            return (*tables, table)
        if frame.axes not in self._carried:
            along = [t for t in tables if measured in t.names]
            names = tuple(dict.fromkeys(n for t in along for n in t.names if n != measured))
            self._carried[frame.axes] = contract((*along, table), (*names, OUTCOME))
        return (*(t for t in tables if measured not in t.names), self._carried[frame.axes])
