"""What the exact engine works out once for a network: the joint table and the groups."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import prod
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from palpate.errors import NetworkError
from palpate.inference.belief import Objective
from palpate.inference.group import Group
from palpate.inference.grouping import groups_of
from palpate.inference.readings import GroupBelief
from palpate.inference.targets import Target
from palpate.inference.tensors import Table
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor

__all__ = ["Compiled", "compiled"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Compiled:
    """The parts of a network as inference uses them.

    Parameters
    ----------
    axes
        Names of the categorical properties: the axes of the joint table.
    log_prior
        Natural log of the prior of all categorical properties together.
    home
        Continuous or derived property to the index of its group.
    priors
        The groups without evidence; what they work out is kept for good.
    """

    axes: tuple[str, ...]
    log_prior: Array
    groups: tuple[Group, ...]
    priors: tuple[GroupBelief, ...]
    home: Mapping[str, int]
    _targets: dict[Objective, Target] = field(default_factory=dict)
    _labels: dict[tuple[str, str], tuple[Array, Array]] = field(default_factory=dict)

    def target(self, network: Network, objective: Objective) -> Target:
        """The parts of an objective, worked out once."""
        if objective not in self._targets:
            self._targets[objective] = Target(network, self.groups, objective)
        return self._targets[objective]

    def first_label(self, action: Action, label: str) -> tuple[Array, Array]:
        """p(label | state), and its natural log shaped to broadcast over the joint table, worked out once."""
        key = (action.name, label)
        if key not in self._labels:
            assert isinstance(action.sensor, ConfusionSensor)
            factor = action.sensor.likelihood([label])
            with np.errstate(divide="ignore"):
                log_factor = self.along(Table(np.log(factor), (action.sensor.property,)))
            self._labels[key] = factor, log_factor
        return self._labels[key]

    def along(self, table: Table) -> Array:
        """The values of a table over categorical properties, shaped to broadcast over the joint table."""
        if table.names == self.axes:
            return table.values
        order = sorted(range(len(table.names)), key=lambda i: self.axes.index(table.names[i]))
        values = table.values.transpose(order)
        shape = iter(values.shape)
        return values.reshape([next(shape) if n in table.names else 1 for n in self.axes])


MAX_CHART = 20_000_000
"""Largest table of three or more linked properties that is worked with."""

_KNOWN: WeakKeyDictionary[Network, Compiled] = WeakKeyDictionary()


def compiled(network: Network) -> Compiled:
    """The compiled network, kept as long as the network is."""
    if network not in _KNOWN:
        axes = tuple(p.name for p in network.categorical)
        groups = groups_of(network)
        for group in groups:
            _check_size(network, group)
        home = {name: i for i, group in enumerate(groups) for name in group.members}
        priors = tuple(GroupBelief(group, {}) for group in groups)
        parts = Compiled(axes, np.zeros((1,) * len(axes)), groups, priors, home)
        shape = tuple(len(p.states) for p in network.categorical)
        log_prior = sum((_log_table(parts, p) for p in network.categorical), np.zeros(shape))
        _KNOWN[network] = Compiled(axes, log_prior, groups, priors, home)
    return _KNOWN[network]


def _check_size(network: Network, group: Group) -> None:
    """Refuse a group of three or more densities whose charts would be too large to work with."""
    if len(group.bases) < 3:
        return
    states = {p.name: len(p.states) for p in network.categorical}
    for sensor in group.sensors:
        for member in group.members:
            frame = group.frame((member, sensor.property) if member != sensor.property else (member,))
            if frame is None:
                continue
            solved = {base for _, base in frame.order}
            parents = {p for name in solved for p in group.bases[name].parents}
            size = prod(m.size for m in group.meshes(frame).values()) * prod(states[p] for p in parents)
            if size > MAX_CHART:
                raise NetworkError(
                    f"network {network.name!r}: {', '.join(group.bases)} are linked by formulas, and to measure "
                    f"{sensor.property!r} takes {size:.0e} numbers, more than {MAX_CHART:.0e}: link fewer properties, "
                    "or give them wider densities"
                )


def _log_table(parts: Compiled, prior: CategoricalProperty) -> Array:
    with np.errstate(divide="ignore"):
        return parts.along(Table(np.log(prior.table), (*prior.parents, prior.name)))
