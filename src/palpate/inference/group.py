"""A group: continuous properties linked by formulas, integrated together by quadrature.

Given the joint state of the categorical properties, groups are independent of each other. What is
here does not depend on evidence; `palpate.inference.readings` adds that.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from palpate.inference.axes import ALONE, base_mesh, derived_mesh, narrowed, scale_given
from palpate.inference.channels import Tables, reading_ends, reading_mesh
from palpate.inference.chart import Chart, Frame, MasterChart
from palpate.inference.mesh import Mesh
from palpate.inference.window import Window, cut
from palpate.network.families import Uniform
from palpate.network.properties import ContinuousProperty, DerivedProperty
from palpate.network.sensors import NumberSensor

__all__ = ["Group"]

Array = NDArray[np.float64]
Names = tuple[str, ...]

MASTER_PANELS = 4000
MASTER_LEVELS = 2
FEW = 16
"""Panels of readings up to which they are as narrow as the noise asks for."""
SHARP = 0.7
"""Share of a sensor's noise that meshes resolve beside it: a few readings together are sharper than one."""
BLUNT = 0.9 * SHARP
"""Share of a sensor's noise that evidence may be as sharp as for meshes to resolve it."""


@dataclass(frozen=True, eq=False)
class Group:
    """Properties with densities of their own, and those derived from them.

    Parameters
    ----------
    parents
        The categorical parents of its members: the names of a configuration's axes.
    sensors
        The sensors of its members, which say how finely evidence can look.
    """

    bases: Mapping[str, ContinuousProperty]
    derived: Mapping[str, DerivedProperty]
    parents: Names
    sensors: tuple[NumberSensor, ...]

    @property
    def members(self) -> Names:
        """All properties of the group, those with densities first."""
        return (*self.bases, *self.derived)

    def mesh(self, frame: Frame, name: str) -> Mesh:
        """The prior mesh of an axis of a frame."""
        solved = dict(frame.order)
        key = (name, tuple(sorted(solved.items())))
        if key not in self._meshes:
            own = [s for s in self.sensors if s.property == name]
            noise = partial(_noise, own) if own else None
            if name in self.bases:
                self._meshes[key] = base_mesh(self.bases[name], self._given(frame, name), noise)
            else:
                inputs = {x: self.bases[x] for x in self.derived[name].formula.variables}
                self._meshes[key] = derived_mesh(self.derived[name], solved[name], inputs, self.parents, noise)
        return self._meshes[key]

    def _given(self, frame: Frame, name: str) -> Callable[[Array], Array] | None:
        """How narrow a density of its own is given a derived axis, as well as its sensors can tell."""
        for axis, solved in frame.order:
            own = [s for s in self.sensors if s.property == axis]
            if own and name in self.derived[axis].formula.variables:
                return self.scale_given(axis, solved, name, partial(_noise, own, share=SHARP))
        return None

    def scale_given(
        self, axis: str, solved: str, name: str, noise: Callable[[Array], Array]
    ) -> Callable[[Array], Array]:
        """How narrow a density of its own is given a derived axis with evidence of some noise."""
        inputs = {x: self.bases[x] for x in self.derived[axis].formula.variables}
        return scale_given(self.derived[axis], solved, name, inputs, noise)

    def read_finely(self, name: str, x: Array, lengths: Array) -> Array:
        """Lengths over which a member's density changes at x, less where its own sensors tell more than that."""
        own = [s for s in self.sensors if s.property == name]
        return narrowed(lengths, _noise(own, x)) if own else lengths

    def meshes(self, frame: Frame) -> dict[str, Mesh]:
        """The prior meshes of a frame's axes."""
        return {name: self.mesh(frame, name) for name in frame.axes}

    def corners(self, name: str) -> Array:
        """Where densities of a member end at once, and do not fade."""
        if name in self.derived:
            return np.array([self.support(name)[0]]) if np.isfinite(self.support(name)[0]) else np.empty(0)
        family = self.bases[name].family
        ends = np.unique(np.stack([family.low, family.high]))
        return ends[np.isfinite(ends)]

    def rank(self, names: Sequence[str]) -> int:
        """How many degrees of freedom some members have together."""
        middle = {
            name: float(np.median(np.asarray(b.family.quantile(np.array(0.4))))) for name, b in self.bases.items()
        }
        step = {name: 1e-6 * max(abs(x), 1e-6) for name, x in middle.items()}
        slopes = np.zeros((len(names), len(self.bases)))
        for row, name in enumerate(names):
            for column, base in enumerate(self.bases):
                if name in self.bases:
                    slopes[row, column] = name == base
                else:
                    f = self.derived[name].formula
                    moved = f.evaluate({**middle, base: middle[base] + step[base]})
                    slopes[row, column] = (moved - f.evaluate(middle)) / step[base] * max(abs(middle[base]), 1e-6)
        size = np.abs(slopes).max(axis=1, keepdims=True)
        return int(np.linalg.matrix_rank(slopes / np.where(size > 0, size, 1), tol=1e-4))

    def support(self, name: str) -> tuple[float, float]:
        """Ends of the support of a member."""
        if name in self.bases:
            family = self.bases[name].family
            return float(family.low.min()), float(family.high.max())
        frame = self.frame((name,))
        assert frame is not None, "every member is an axis of some chart"
        mesh = self.mesh(frame, name)
        return (mesh.origin if mesh.graded.any() else -np.inf), np.inf

    def frame(self, required: Names, touched: frozenset[str] = frozenset()) -> Frame | None:
        """The best choice of axes with the required ones among them, None where there is none.

        As many members with evidence as possible are axes, so that it is not a ridge across the
        mesh; what is solved for is smooth and wide where it can be; then as many properties as
        possible are axes that have densities of their own.
        """
        key = (required, touched)
        if key not in self._frames:
            fitting = [c for c in combinations(self.members, len(self.bases)) if set(required) <= set(c)]
            solved = [(c, order) for c in fitting if (order := self._order(c)) is not None]
            best = max(solved, key=lambda s: self._merit(s, touched), default=None)
            frame = Frame(*best, self.bases, self.derived, self.parents) if best else None
            self._frames[key] = self._same.setdefault(frame.axes, frame) if frame else None
        return self._frames[key]

    def _merit(self, solved: tuple[Names, tuple[tuple[str, str], ...]], touched: frozenset[str]) -> tuple[float, ...]:
        axes, order = solved
        edged = sum(isinstance(self.bases[base].family, Uniform) for _, base in order)
        return len(touched & set(axes)), -edged, sum(x in self.bases for x in axes)

    def _order(self, axes: Names) -> tuple[tuple[str, str], ...] | None:
        """(derived axis, base it gives) in the order of solving; None if the axes do not fix all bases."""
        known = {name for name in axes if name in self.bases}
        waiting = [name for name in axes if name in self.derived]
        order: list[tuple[str, str]] = []
        while waiting:
            ready = [(name, unknown) for name in waiting for unknown in self._given_by(name, known)]
            if not ready:
                return None
            order.append(ready[0])
            known.add(ready[0][1])
            waiting.remove(ready[0][0])
        return tuple(order) if len(known) == len(self.bases) else None

    def _given_by(self, derived: str, known: set[str]) -> Names:
        """The one base that a derived property gives when the known ones are known, if it does."""
        formula = self.derived[derived].formula
        unknown = tuple(x for x in formula.variables if x not in known)
        return unknown if len(unknown) == 1 and unknown[0] in formula.solvable() else ()

    @cached_property
    def _frames(self) -> dict[tuple[Names, frozenset[str]], Frame | None]:
        return {}

    @cached_property
    def _same(self) -> dict[Names, Frame]:
        """One frame per choice of axes, so that charts are kept once."""
        return {}

    @cached_property
    def _masters(self) -> dict[tuple[Names, int], MasterChart]:
        return {}

    def window_chart(self, frame: Frame, window: Window) -> Chart | None:
        """The chart without evidence on the window of its last axis; None where no master mesh resolves it."""
        if not self._blunt(frame.axes[-1], window):
            return None
        for level in range(MASTER_LEVELS):
            mesh = self.master_mesh(frame, level)
            panels = window.panels(mesh)
            if panels is None:
                return None
            if window.resolved(mesh, *panels):
                return self.master(frame, level).window(*panels)
        return None

    def master(self, frame: Frame, level: int) -> MasterChart:
        """The chart without evidence on the master mesh of its last axis."""
        key = (frame.axes, level)
        if key not in self._masters:
            meshes = {**self.meshes(frame), frame.axes[-1]: self.master_mesh(frame, level)}
            self._masters[key] = MasterChart(frame, meshes)
        return self._masters[key]

    def whole_chart(self, frame: Frame, window: Window) -> Chart | None:
        """The chart without evidence of one density alone, on a mesh that resolves its sensors.

        None where the evidence is sharper than the sensors, or lies beyond the mesh.
        """
        mesh = self.master_mesh(frame, 0)
        if not self._blunt(frame.axes[-1], window) or any(
            low > mesh.edges[-1] or high < mesh.edges[0] for low, high, _ in window.fine
        ):
            return None
        # A sensor far sharper than the prior is wide is more than this mesh, limited in size, resolves.
        sharp = Window(window.low, window.high, tuple((low, high, ALONE * scale) for low, high, scale in window.fine))
        if not sharp.resolved(mesh, 0, len(mesh.edges) - 1):
            return None
        return self.whole(frame)

    def whole(self, frame: Frame) -> Chart:
        """The chart without evidence of one density alone, on its master mesh."""
        if frame.axes not in self._wholes:
            self._wholes[frame.axes] = frame.chart({frame.axes[-1]: self.master_mesh(frame, 0)})
        return self._wholes[frame.axes]

    @cached_property
    def _wholes(self) -> dict[Names, Chart]:
        return {}

    def _blunt(self, name: str, window: Window) -> bool:
        """Whether evidence on a member is no sharper than the other axes' meshes are made for."""
        own = [s for s in self.sensors if s.property == name]
        if not own:
            return False
        if not any(s.relative_sd for s in own):
            return all(scale >= BLUNT * math.hypot(s.sd, s.offset_sd) for *_, scale in window.fine for s in own)
        return all(scale >= BLUNT * _noise(own, np.array([low, high])).min() for low, high, scale in window.fine)

    def master_mesh(self, frame: Frame, level: int) -> Mesh:
        """The prior mesh of the last axis cut so that it resolves its sensors; finer by halves at each level."""
        key = (frame.axes, level)
        if key not in self._master_meshes:
            name = frame.axes[-1]
            prior = self.mesh(frame, name)
            middles = (prior.edges[1:] + prior.edges[:-1]) / 2
            own = [s for s in self.sensors if s.property == name]
            least = prior.edges[-1] / MASTER_PANELS
            alone = SHARP * ALONE if len(frame.axes) == 1 else 1.0
            scale = np.maximum(alone * _noise(own, middles), least) if own else np.diff(prior.edges)
            self._master_meshes[key] = cut(prior, scale) if level == 0 else self.master_mesh(frame, level - 1).halved()
        return self._master_meshes[key]

    def reading_mesh(self, sensor: NumberSensor, low: float, high: float) -> Mesh | None:
        """A mesh of readings of a member between two values, as fine as the noise; None where that is far to go."""
        master = self._reading_master(sensor)
        low, high = reading_ends(sensor, low, high)
        if low < master.edges[0] or high > master.edges[-1]:
            return None
        first = int(np.searchsorted(master.edges, low, "right")) - 1
        last = int(np.searchsorted(master.edges, high))
        return master.between(first, last) if first < last <= first + FEW else None

    def _reading_master(self, sensor: NumberSensor) -> Mesh:
        """The mesh of all readings that the prior leaves possible, and of some beyond."""
        if id(sensor) not in self._reading_masters:
            frame = self.frame((sensor.property,))
            assert frame is not None, "every member is an axis of some chart"
            own, corners = self.mesh(frame, sensor.property), self.corners(sensor.property)
            self._reading_masters[id(sensor)] = reading_mesh(sensor, [own], corners, only_noise=True)
        return self._reading_masters[id(sensor)]

    @cached_property
    def tables(self) -> Tables:
        """Tables of sensors that no reading changes, kept for all beliefs."""
        return {}

    @cached_property
    def _reading_masters(self) -> dict[int, Mesh]:
        return {}

    @cached_property
    def _meshes(self) -> dict[tuple[str, tuple[tuple[str, str], ...]], Mesh]:
        return {}

    @cached_property
    def _master_meshes(self) -> dict[tuple[Names, int], Mesh]:
        return {}


def _noise(sensors: Sequence[NumberSensor], x: Array, share: float = 1.0) -> Array:
    """The least noise of several sensors at values x, or a share of it."""
    flat = np.ravel(x)
    return share * np.asarray(np.min([np.hypot(s.scale(flat), s.offset_sd) for s in sensors], axis=0)).reshape(
        np.shape(x)
    )
