"""Continuous properties that depend on each other given the categorical ones, on dense grids.

A group is one property (`Single`) or two with a property derived from both (`Pair`). Given every
joint state j of the categorical properties it yields the evidence's integral and, on a grid, the
posterior mass of each of its properties.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.network.families import Gamma, LogNormal, Normal, StudentT, Uniform
from palpate.network.properties import ContinuousProperty
from tests.oracle import densities
from tests.oracle.grids import Grid, grid, near, walk

Array = NDArray[np.float64]
Index = NDArray[np.intp]
LogLikelihood = Callable[[Array], Array]


@dataclass(frozen=True)
class Link:
    """How a derived property follows from two others and back; slopes are absolute.

    Parameters
    ----------
    second_given
        (first, derived) -> (second, |d second / d derived|); `first_given` the other way round.
    log
        Whether all three are positive and want geometric panels.
    """

    derived: str
    first: str
    second: str
    forward: Callable[[Array, Array], Array]
    second_given: Callable[[Array, Array], tuple[Array, Array]]
    first_given: Callable[[Array, Array], tuple[Array, Array]]
    log: bool


def product(derived: str, first: str, second: str, factor: float) -> Link:
    """Derived = factor x first x second."""

    def other(one: Array, value: Array) -> tuple[Array, Array]:
        return value / (factor * one), 1 / (factor * one)

    return Link(derived, first, second, lambda a, b: factor * a * b, other, other, True)


def total(derived: str, first: str, second: str) -> Link:
    """Derived = first + second."""

    def other(one: Array, value: Array) -> tuple[Array, Array]:
        return value - one, np.ones(np.broadcast_shapes(one.shape, value.shape))

    return Link(derived, first, second, lambda a, b: a + b, other, other, False)


@dataclass(frozen=True)
class Feature:
    """Where the evidence or a sensor asks for narrow panels."""

    centre: float
    width: float


def spans(prop: ContinuousProperty, log: bool) -> tuple[float, float, float, list[float]]:
    """Ends that hold all the prior mass, the least local width, and where the density jumps."""
    family = prop.family
    if isinstance(family, Normal):
        low = np.maximum(family.low, family.mean - 16 * family.sd)
        high = np.minimum(family.high, family.mean + 16 * family.sd)
        width, jumps = family.sd, [float(v) for v in (*np.ravel(family.low), *np.ravel(family.high)) if np.isfinite(v)]
    elif isinstance(family, LogNormal):
        low, high = family.median * np.exp(-10 * family.log_sd), family.median * np.exp(10 * family.log_sd)
        width, jumps = family.median * family.log_sd, []
    elif isinstance(family, Gamma):
        low, high = np.zeros_like(family.scale), family.scale * (family.shape + 60 + 12 * np.sqrt(family.shape))
        width, jumps = family.scale * np.sqrt(family.shape), []
    elif isinstance(family, Uniform):
        low, high, width = family.low, family.high, family.high - family.low
        jumps = [float(v) for v in (*np.ravel(low), *np.ravel(high))]
    else:
        assert isinstance(family, StudentT)
        reach = family.scale * 3e3
        low, high, width, jumps = family.location - reach, family.location + reach, family.scale, []
    start = float(np.min(low))
    if log:
        start = max(start, 1e-11 * float(np.max(width)))
    return start, float(np.max(high)), float(np.min(width)), jumps


def is_log(prop: ContinuousProperty) -> bool:
    """Whether a property of its own wants geometric panels."""
    return isinstance(prop.family, LogNormal | Gamma)


def base_grid(
    prop: ContinuousProperty,
    log: bool,
    refine: float,
    features: Sequence[Feature],
    finest: float,
    ratio: float = 0.1,
    ends: tuple[float, float] | None = None,
) -> Grid:
    """A grid over the whole prior, or between the ends.

    `finest` is the widest panel that later noise allows, `ratio` the widest geometric one.
    """
    low, high, width, jumps = spans(prop, log)
    low, high = ends or (low, high)
    middle = float(np.mean(np.ravel(prop.family.location))) if isinstance(prop.family, StudentT) else None

    def step(x: float) -> float:
        # A heavy tail is too long for panels of one width; what little it holds is smooth there.
        beyond = 0.0 if middle is None else max(0.0, abs(x - middle) - 40 * width) / 4
        if log:
            widest = x * (ratio if x > width else 0.15 if x > 1e-4 * width else 0.4)
        else:
            widest = 0.7 * width + (0.0 if middle is None else abs(x - middle) / 4)
        return refine * min([widest, finest + beyond, *(near(f.centre, f.width)(x) for f in features)])

    inner = sorted({v for v in jumps if low < v < high})
    cuts = [low, *inner, high]
    parts = [walk(a, b, step, log).edges for a, b in pairwise(cuts)]
    return grid(np.concatenate([parts[0], *(part[1:] for part in parts[1:])]), log)


@dataclass(frozen=True, eq=False)
class Integrated:
    """A group given the evidence: ln integral [J] and the tables of its properties.

    Parameters
    ----------
    tables
        Property to (grid, mass of the property given joint state j [J, N], rows sum to one).
    cross
        (z, x, weights [J]) -> joint masses [Nz, Nx] of two properties of the group.
    """

    log_z: Array
    tables: Mapping[str, tuple[Grid, Array]]
    cross: Callable[[str, str, Array], Array]


def _no_cross(z: str, x: str, weights: Array) -> Array:
    raise NotImplementedError(f"the oracle has no joint table of {z} and {x}")


def single(prop: ContinuousProperty, index: Index, log_l: LogLikelihood, on: Grid) -> Integrated:
    """One property; index [J] is its configuration in each joint state."""
    rows = []
    for config in range(int(index.max()) + 1):
        rows.append(densities.prior(prop.family, config)(on.x) + log_l(on.x) + np.log(on.w))
    log_mass = np.array(rows)
    peak = log_mass.max(axis=1, keepdims=True)
    peak = np.where(np.isfinite(peak), peak, 0.0)
    mass = np.exp(log_mass - peak)
    z = mass.sum(axis=1, keepdims=True)
    with np.errstate(divide="ignore"):
        log_z = (np.log(z) + peak)[:, 0]
    table = mass / np.where(z > 0, z, 1.0)
    return Integrated(log_z[index], {prop.name: (on, table[index])}, _no_cross)


@dataclass(frozen=True, eq=False)
class _Side:
    """Half of a pair in coordinates (one, derived): slabs[config of the other] [None, Nd]."""

    own: Array  # (configs of one, N one): prior x likelihood x weight, scaled
    slabs: list[Array]  # per config of the other: (N one, N derived), scaled, with the derived's weight
    log_scale: Array  # (configs of one, configs of the other)


def _side(
    props: tuple[ContinuousProperty, ContinuousProperty], on: tuple[Grid, Grid], solve: Any, log_ls: Any
) -> _Side:
    """`props` (one, other), `on` grids of (one, derived), `log_ls` of (one, other, derived)."""
    one, other = props
    log_one, log_other, log_derived = log_ls
    own = np.array([densities.prior(one.family, c)(on[0].x) for c in range(_configs(one))]) + log_one(on[0].x)
    own += np.log(on[0].w)
    own_peak = own.max(axis=1)
    partner, slope = solve(on[0].x[:, None], on[1].x[None, :])
    shared = (
        log_other(partner.ravel()).reshape(partner.shape) + np.log(slope) + (log_derived(on[1].x) + np.log(on[1].w))
    )
    slabs, peaks = [], []
    for config in range(_configs(other)):
        slab = densities.prior(other.family, config)(partner) + shared
        peaks.append(slab.max())
        slabs.append(np.exp(slab - peaks[-1]))
    return _Side(np.exp(own - own_peak[:, None]), slabs, own_peak[:, None] + np.array(peaks)[None, :])


def _configs(prop: ContinuousProperty) -> int:
    family = prop.family
    first = getattr(family, "mean", getattr(family, "median", getattr(family, "scale", None)))
    return int(np.size(first if first is not None else family.low))


def pair(
    props: tuple[ContinuousProperty, ContinuousProperty],
    index: tuple[Index, Index],
    link: Link,
    log_ls: tuple[LogLikelihood, LogLikelihood, LogLikelihood],
    on: tuple[Grid, Grid, Grid],
    check: Array | None = None,
) -> Integrated:
    """Two properties and the one derived from them; arguments in the order first, second, derived.

    `check` is the log weight of each joint state by the evidence outside the group; with it, the two
    ways to integrate the group are compared.
    """
    ia, ib = index
    left = _side(props, (on[0], on[2]), link.second_given, (log_ls[0], log_ls[1], log_ls[2]))
    right = _side((props[1], props[0]), (on[1], on[2]), link.first_given, (log_ls[1], log_ls[0], log_ls[2]))
    table_a, table_d, log_z = _tables(left, ia, ib)
    table_b, _, log_z_again = _tables(right, ib, ia)
    # Both sides integrate the same thing: a check of the grids that costs nothing.
    if check is not None:
        weights = np.exp(check + log_z - (check + log_z).max())
        likely = weights > 0
        apart = float((weights[likely] * np.abs(log_z[likely] - log_z_again[likely])).max())
        if not apart < 1e-6:
            raise ArithmeticError(f"the oracle's grids are too coarse: the sides differ by {apart:.1e}")

    def cross(z: str, x: str, weights: Array) -> Array:
        if x == link.derived and z in (link.first, link.second):
            return _joint(left, ia, ib, log_z, weights) if z == link.first else _joint(right, ib, ia, log_z, weights)
        if z == link.derived:
            return cross(x, z, weights).T
        base = _base(props, index, link, log_ls, on, weights, log_z)
        return base if (z, x) == (link.first, link.second) else base.T

    tables = {link.first: (on[0], table_a), link.second: (on[1], table_b), link.derived: (on[2], table_d)}
    return Integrated(log_z, tables, cross)


def _tables(side: _Side, mine: Index, others: Index) -> tuple[Array, Array, Array]:
    ones, deriveds, zs = [], [], []
    for slab in side.slabs:
        ones.append(side.own * slab.sum(axis=1))
        deriveds.append(side.own @ slab)
        zs.append(ones[-1].sum(axis=1))
    z = np.array(zs).T
    with np.errstate(divide="ignore"):
        log_z = np.log(z) + side.log_scale
    safe = np.where(z > 0, z, 1.0)
    one, derived = np.array(ones), np.array(deriveds)
    scale = safe[mine, others][:, None]
    return one[others, mine] / scale, derived[others, mine] / scale, log_z[mine, others]


def _joint(side: _Side, mine: Index, others: Index, log_z: Array, weights: Array) -> Array:
    share = np.zeros((len(side.own), len(side.slabs)))
    on = weights > 0
    np.add.at(share, (mine[on], others[on]), weights[on] * np.exp(side.log_scale[mine[on], others[on]] - log_z[on]))
    return np.asarray(sum((share[:, c] @ side.own)[:, None] * slab for c, slab in enumerate(side.slabs)))


def _base(props: Any, index: Any, link: Link, log_ls: Any, on: Any, weights: Array, log_z: Array) -> Array:
    """Joint masses of the first and the second: only for evidence broad enough for their grids."""
    a, b = on[0].x[:, None], on[1].x[None, :]
    derived = link.forward(a, b)
    shared = log_ls[2](derived.ravel()).reshape(derived.shape) + log_ls[0](on[0].x)[:, None] + log_ls[1](on[1].x)
    shared = shared + np.log(on[0].w)[:, None] + np.log(on[1].w)
    joint = np.zeros(derived.shape)
    for j in np.flatnonzero(weights > 0):
        prior_a = densities.prior(props[0].family, int(index[0][j]))(on[0].x)[:, None]
        prior_b = densities.prior(props[1].family, int(index[1][j]))(on[1].x)
        joint += weights[j] * np.exp(shared + prior_a + prior_b - log_z[j])
    return joint
