"""Joint tables of a belief: of states, and of nodes of continuous properties.

For gains a view leaves out what is too improbable to change one: faint states and nodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import prod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError
from palpate.inference.channels import OUTCOME
from palpate.inference.chart import Frame
from palpate.inference.next_reading import NextReading
from palpate.inference.readings import GroupBelief
from palpate.inference.targets import Target
from palpate.inference.tensors import Table, contract

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["View", "per_mass"]

Array = NDArray[np.float64]
Names = tuple[str, ...]

FAINT = 3e-7
"""Nodes at the ends of an axis less probable than this are left out of gains."""
FAINT_STATE = 1e-13
"""States less probable than this are left out: what is left agrees with the whole to 1e-11 bits."""
NO_MASS = 1e-280
ALL = slice(None)
SMALL = 400
"""Joint states of the categorical properties up to which rows are never too many."""
MAX_ENTRIES = 50_000_000
"""Largest joint table of an objective's nodes and categorical properties."""


class View:
    """A belief's tables, each put together once.

    Parameters
    ----------
    whole
        Whether to keep the states and nodes that are too improbable to matter.
    """

    def __init__(self, belief: ExactBelief, whole: bool = False) -> None:
        self.belief = belief
        self.axes = belief.parts.axes
        self._whole = whole
        self._keep: dict[str, NDArray[np.intp]] = {}
        joint = belief.joint.values
        for i, name in enumerate(() if whole else self.axes):
            total = joint.sum(axis=tuple(k for k in range(joint.ndim) if k != i))
            kept = np.flatnonzero(total > FAINT_STATE)
            if len(kept) < len(total):
                self._keep[name] = kept
                joint = joint.take(kept, axis=i)
        self._joint = Table(joint, self.axes)
        self._orders: dict[frozenset[str], Names] = {}
        self._joints: dict[tuple[Names, Names], Table] = {}
        self._ranges: dict[tuple[Names, str], slice] = {}
        self._factors: dict[tuple[Names, Names], tuple[Table, ...]] = {}

    def home(self, name: str) -> GroupBelief:
        """The group of a continuous property, with its readings."""
        return self.belief.groups[self.belief.parts.home[name]]

    def ordered(self, names: Iterable[str]) -> Names:
        """Categorical properties in the network's order."""
        chosen = frozenset(names)
        if chosen not in self._orders:
            self._orders[chosen] = tuple(n for n in self.axes if n in chosen)
        return self._orders[chosen]

    def kept(self, table: Table) -> Table:
        """A table without the states that are left out."""
        if not self._keep:
            return table
        values = table.values
        for i, name in enumerate(table.names):
            if name in self._keep:
                values = values.take(self._keep[name], axis=i)
        return Table(values, table.names)

    def categorical(self, names: Names) -> Table:
        """The joint table of some categorical properties."""
        return self._joint.sum_to(names)

    def joint(self, members: Names, names: Names) -> Table:
        """Joint of categorical properties and of the nodes of continuous properties, in that order."""
        if not members:
            return self.categorical(names)
        key = (members, names)
        if key not in self._joints:
            if len(members) > 1:
                self._check_size(members, names)
            self._joints[key] = contract(self._spread(members, names), (*names, *members))
        return self._joints[key]

    def _with_parents(self, names: Iterable[str], groups: Iterable[GroupBelief]) -> Table:
        """Joint of categorical properties and of the parents of groups."""
        return self.categorical(self.ordered({*names, *(p for g in groups for p in g.group.parents)}))

    def _spread(self, members: Names, names: Names) -> list[Table]:
        """Tables whose product, summed to members and names, is their joint probability."""
        homes = sorted({self.belief.parts.home[m] for m in members})
        groups = [self.belief.groups[h] for h in homes]
        weights = self._with_parents(names, groups)
        tables: list[Table] = []
        for home, group in zip(homes, groups, strict=True):
            own = tuple(m for m in members if self.belief.parts.home[m] == home)
            frame = group.sure_frame(*own)
            weights = per_mass(weights, self.kept(group.mass(frame)))
            tables += self._trimmed(group, frame, own)
        return [weights, *tables]

    def members(self, target: Target) -> Names:
        """The axes that stand for the target's continuous properties."""
        return target.members(self.belief.groups) if target.whole else target.partial

    def beside(self, target: Target, reading: NextReading) -> Array:
        """Joint of an objective with members in the measured property's group, and of the reading (rows, Y)."""
        measured = reading.sensor.property
        home = self.home(measured)
        members = self.members(target)
        own = tuple(m for m in members if m in home.group.members)
        far = tuple(m for m in members if m not in own)
        frame = home.frame(*own, measured) or home.sure_frame(*own)
        weights, *tables = self._spread(far, (*target.categorical, *home.group.parents))
        weights = per_mass(weights, self.kept(home.mass(frame)))
        tables += self._through(home, frame, reading)
        joint = contract((weights, *tables), (*members, *target.categorical, OUTCOME)).values
        return joint.reshape(-1, joint.shape[-1])

    def _through(self, home: GroupBelief, frame: Frame, reading: NextReading) -> tuple[Table, ...]:
        measured = reading.sensor.property
        if not home.touched or measured not in frame.axes:
            return tuple(self.kept(t) for t in reading.through(frame))
        table = reading.channel.table(home.chart(frame).meshes[measured])[self._nodes(home, frame, measured)]
        return (*self._trimmed(home, frame, frame.axes), Table(table, (measured, OUTCOME)))

    def _trimmed(self, group: GroupBelief, frame: Frame, axes: Names) -> tuple[Table, ...]:
        key = (frame.axes, axes)
        if key not in self._factors:
            tables = group.reduced(frame, *axes)
            ranges = {n: self._nodes(group, frame, n) for n in frame.axes if any(n in t.names for t in tables)}
            self._factors[key] = tuple(self._cut(t, ranges) for t in tables)
        return self._factors[key]

    def _cut(self, table: Table, ranges: Mapping[str, slice]) -> Table:
        return self.kept(Table(table.values[tuple(ranges.get(n, ALL) for n in table.names)], table.names))

    def _nodes(self, group: GroupBelief, frame: Frame, name: str) -> slice:
        """The nodes of an axis that matter."""
        if self._whole:
            return ALL
        key = (frame.axes, name)
        if key not in self._ranges:
            held = np.flatnonzero(self.belief.axis_masses(group, frame, name) > FAINT)
            self._ranges[key] = slice(int(held[0]), int(held[-1]) + 1)
        return self._ranges[key]

    def rows_size(self, targets: Iterable[Target], names: Names) -> int:
        """Entries of the rows of all targets with the named categorical properties, at most."""
        if self._joint.values.size <= SMALL:
            return 0
        return sum(self._size(self.members(t), {*t.categorical, *names}) for t in targets)

    def _size(self, members: Names, names: Iterable[str]) -> int:
        sizes = dict(zip(self.axes, self._joint.values.shape, strict=True))
        homes = [self.home(m) for m in members]
        nodes = [h.chart(h.sure_frame(m)).meshes[m].size for h, m in zip(homes, members, strict=True)]
        return prod([*nodes, *(sizes[n] for n in names)])

    def _check_size(self, members: Names, names: Names) -> None:
        if (size := self._size(members, names)) > MAX_ENTRIES:
            raise EvidenceError(
                f"an objective of {', '.join((*members, *names))} together needs {size:.0e} numbers, "
                f"more than {MAX_ENTRIES:.0e}: choose fewer properties, or everything"
            )


def per_mass(weights: Table, mass: Table) -> Table:
    """Weights over categorical properties divided by a chart's total per configuration; without mass 0."""
    held = mass.values > NO_MASS
    if held.all():
        inverse = 1.0 / mass.values
    else:
        inverse = np.divide(1.0, mass.values, out=np.zeros_like(mass.values), where=held)
    if mass.names == weights.names:
        return Table(weights.values * inverse, weights.names)
    shape = iter(inverse.shape)
    shaped = inverse.reshape([next(shape) if n in mass.names else 1 for n in weights.names])
    return Table(weights.values * shaped, weights.names)
