"""Charts: a group's densities over a tensor mesh of some of its members.

A chart has as many axes as the group has properties with densities of their own. An axis may be a
derived property: the base that its formula gives is then solved for, with the slope that the
change of variables asks for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from palpate.inference.mesh import ORDER, Mesh
from palpate.inference.tensors import Table, contract
from palpate.network.properties import ContinuousProperty, DerivedProperty

__all__ = ["Chart", "Frame", "MasterChart"]

Array = NDArray[np.float64]
Names = tuple[str, ...]

TRUSTED = 0.5
"""Larger errors of a prior's total than this are no errors of quadrature: the mesh ends there."""
BLOCK = 16 * ORDER
"""Nodes that a master chart works out at a time."""


@dataclass(frozen=True, eq=False)
class Chart:
    """Tables whose product is proportional to p(axes, readings | configuration) x weights.

    The product is to be multiplied by exp(log_along), a vector along the last axis: what is taken
    out of the tables there, so that nothing that counts underflows however far the tail.

    Parameters
    ----------
    totals
        The tables' product summed to the last axis and the configurations, where it is known.
    """

    tables: tuple[Table, ...]
    log_along: Array
    meshes: Mapping[str, Mesh]
    totals: Table | None = None

    def with_likelihood(self, log_likelihood: Array) -> Chart:
        """The chart times a likelihood along its last axis."""
        return replace(self, log_along=self.log_along + log_likelihood)

    @cached_property
    def log_scale(self) -> float:
        """Natural log of the factor left out of `factors`."""
        return max(float(self.log_along.max()), -1e300)

    @cached_property
    def factors(self) -> tuple[Table, ...]:
        """All tables, the vector along the last axis among them, scaled to maximum 1."""
        return (*self.tables, self.along)

    @cached_property
    def along(self) -> Table:
        """The vector along the last axis, scaled to maximum 1."""
        *_, last = self.meshes
        return Table(np.exp(self.log_along - self.log_scale), (last,))

    @cached_property
    def reduced(self) -> tuple[Table, ...]:
        """The factors with the last axis summed out."""
        *_, last = self.meshes
        with_last = [t for t in self.tables if last in t.names]
        names = tuple(dict.fromkeys(n for t in with_last for n in t.names if n != last))
        return (*(t for t in self.tables if last not in t.names), contract((*with_last, self.along), names))


@dataclass(frozen=True, eq=False)
class Frame:
    """Which members are axes and how the others follow.

    Parameters
    ----------
    order
        (derived axis, base that it gives), in the order in which they can be solved.
    """

    axes: Names
    order: tuple[tuple[str, str], ...]
    bases: Mapping[str, ContinuousProperty]
    derived: Mapping[str, DerivedProperty]
    parents: Names

    def values(self, points: Mapping[str, Array]) -> tuple[dict[str, Array], Array]:
        """Values of all bases and axes from those of the axes, and the log slope of the change of variables."""
        values = dict(points)
        log_slope = np.zeros(np.broadcast_shapes(*(p.shape for p in points.values())))
        for axis, base in self.order:
            values[base], slope = self.derived[axis].formula.solve(base, values[axis], values)
            with np.errstate(divide="ignore"):
                log_slope = log_slope + np.log(slope)
        return values, log_slope

    def tensor(self, meshes: Mapping[str, Mesh]) -> dict[str, Array]:
        """The nodes of the axes, shaped to broadcast to the chart."""
        return {name: self.along(meshes[name].nodes, name) for name in self.axes}

    def along(self, values: Array, name: str) -> Array:
        """A vector over one axis, shaped to broadcast over all."""
        return values.reshape([-1 if axis == name else 1 for axis in self.axes])

    def chart(self, meshes: Mapping[str, Mesh], log_likelihood: Array | float = 0.0) -> Chart:
        """The chart on meshes of the axes, times a likelihood over its tensor mesh."""
        values, rest = self.values(self.tensor(meshes))
        rest = rest + log_likelihood
        for name in self.axes:
            rest = rest + self.along(meshes[name].log_weights, name)
        tables: list[Table] = []
        for name in (n for n in self.axes if n in self.bases):
            log_p = self.bases[name].family.log_density(meshes[name].nodes)
            peak = log_p.max(axis=tuple(range(log_p.ndim - 1)), initial=-1e300)
            tables.append(Table(np.exp(log_p - peak), (*self.bases[name].parents, name)))
            rest = rest + self.along(peak, name)
        rest, names = self._times_solved(rest, values)
        peak = np.maximum(rest.max(axis=tuple(range(rest.ndim - 1))), -1e300)
        if rest.ndim > 1 or not tables:
            tables.append(Table(np.exp(rest - peak), names))
        return Chart(tuple(tables), np.where(peak <= -1e300, -np.inf, peak), {n: meshes[n] for n in self.axes})

    def prior(self, meshes: Mapping[str, Mesh]) -> Chart:
        """The chart on meshes of all of its axes, without evidence.

        The density solved for integrates to one along a derived axis, whatever the others are:
        where it has corners, as a uniform one has, quadrature misses that a little, and is put right.
        """
        chart = self.chart(meshes)
        if len(self.order) != 1 or self.order[0][0] != self.axes[-1]:
            return chart
        *own, rest = chart.tables
        full = rest.values * np.exp(chart.log_along)
        wanted = np.ones((1,) * (rest.values.ndim - 1))
        for table, name in zip(own, self.axes[:-1], strict=True):
            density = np.exp(self.bases[name].family.log_density(meshes[name].nodes))
            peak = density.max(axis=tuple(range(density.ndim - 1)))
            wanted = wanted * _spread(peak * meshes[name].weights, table.names[-1:], rest.names[:-1])
        share = np.divide(full.sum(axis=-1), wanted, out=np.ones(full.shape[:-1]), where=wanted > 0)
        share = np.where(np.abs(share - 1) < TRUSTED, share, 1.0)
        return replace(chart, tables=(*own, Table(rest.values / share[..., None], rest.names)))

    def _times_solved(self, rest: Array, values: Mapping[str, Array]) -> tuple[Array, Names]:
        names = self.axes
        for base in (b for b in self.bases if b not in self.axes):
            own = self.bases[base].parents
            merged = (*(p for p in self.parents if p in own or p in names), *self.axes)
            log_p = self.bases[base].family.log_density(values[base])
            rest = _spread(rest, names, merged) + _spread(log_p, (*own, *self.axes), merged)
            names = merged
        return rest, names


def _spread(values: Array, have: Names, want: Names) -> Array:
    """Axes named `have` brought into the order of `want`, with length one where they are missing."""
    moved = values.transpose([have.index(n) for n in want if n in have])
    shape = iter(moved.shape)
    return moved.reshape([next(shape) if n in have else 1 for n in want])


class MasterChart:
    """A chart without evidence on a fine mesh of its last axis, worked out block by block when asked for.

    Readings of the last axis look at a window of it: their update then evaluates no density. Its
    largest table has the last axis first, so that a window is one stretch of memory.
    """

    def __init__(self, frame: Frame, meshes: Mapping[str, Mesh]) -> None:
        self.frame = frame
        self.meshes = meshes
        self.mesh = meshes[frame.axes[-1]]
        self._ready = np.zeros(-(-self.mesh.size // BLOCK), dtype=bool)
        self._tables: tuple[Table, ...] = ()
        self._rest = self._totals = np.empty(0)
        self._log_along = np.empty(self.mesh.size)

    def window(self, first: int, last: int) -> Chart:
        """The chart on panels first to last - 1 of the last axis."""
        start, stop, name = first * ORDER, last * ORDER, self.frame.axes[-1]
        for block in range(start // BLOCK, (stop - 1) // BLOCK + 1):
            if not self._ready[block]:
                self._fill(block)
        *own, rest = self._tables
        window = Table(self._rest[start:stop], (name, *rest.names[:-1]))
        totals = Table(self._totals[start:stop], (name, *self.frame.parents))
        meshes = {**self.meshes, name: self.mesh.between(first, last)}
        return Chart((*own, window), self._log_along[start:stop], meshes, totals)

    def _fill(self, block: int) -> None:
        panels, name = BLOCK // ORDER, self.frame.axes[-1]
        part = self.mesh.between(block * panels, min((block + 1) * panels, len(self.mesh.edges) - 1))
        chart = self.frame.chart({**self.meshes, name: part})
        totals = contract(chart.tables, (name, *self.frame.parents)).values
        rest = np.moveaxis(chart.tables[-1].values, -1, 0)
        if not self._tables:
            self._tables = chart.tables
            self._rest = np.empty((self.mesh.size, *rest.shape[1:]))
            self._totals = np.empty((self.mesh.size, *totals.shape[1:]))
        here = slice(block * BLOCK, block * BLOCK + part.size)
        self._rest[here], self._totals[here] = rest, totals
        self._log_along[here] = chart.log_along
        self._ready[block] = True
