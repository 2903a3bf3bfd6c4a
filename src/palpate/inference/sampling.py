"""Draws from the belief: configurations from the joint table, then each group given its configuration."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.inference.chart import Frame
from palpate.inference.mesh import Mesh
from palpate.inference.readings import GroupBelief

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["sample"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]

BOUND = 4.0
"""Largest density within a cell over its mean, for rejection; beyond it only far tails are cut."""


def sample(belief: ExactBelief, n: int, rng: np.random.Generator) -> dict[str, Array | NDArray[np.str_]]:
    """n draws of all properties together, in the network's order."""
    shape = belief.joint.values.shape
    flat = rng.choice(belief.joint.values.size, size=n, p=belief.joint.values.ravel())
    states: dict[str, Index] = dict(zip(belief.parts.axes, np.unravel_index(flat, shape), strict=True)) if shape else {}
    values: dict[str, Array] = {}
    for group in belief.groups:
        values.update(_draw_group(group, states, n, rng))
    for derived in belief.network.derived:
        values[derived.name] = derived.formula.evaluate(values)
    labels = {p.name: np.array(p.states)[states[p.name]] for p in belief.network.categorical}
    return {name: labels[name] if name in labels else values[name] for name in belief.network.properties}


def _draw_group(belief: GroupBelief, states: dict[str, Index], n: int, rng: np.random.Generator) -> dict[str, Array]:
    if not belief.touched:
        return {
            name: _own(np.asarray(base.family.quantile(u)), tuple(states[p] for p in base.parents))
            for name, base in belief.group.bases.items()
            for u in [rng.random(n)]
        }
    frame, parents = belief.sure_frame(), belief.group.parents
    table = belief.mass(frame, *frame.axes).values
    drawn: dict[str, Array] = {name: np.empty(n) for name in belief.group.bases}
    waiting = np.arange(n)
    while len(waiting):
        own = tuple(states[p][waiting] for p in parents)
        rows = np.zeros(len(waiting), dtype=np.intp)
        if own:
            rows = np.ravel_multi_index(own, table.shape[: len(own)])
        found, ratio = _propose(belief, table, own, rows, frame, rng)
        taken = rng.random(len(waiting)) * BOUND < ratio
        for name, x in found.items():
            drawn[name][waiting[taken]] = x[taken]
        waiting = waiting[~taken]
    return drawn


def _own(values: Array, states: tuple[Index, ...]) -> Array:
    """From (configurations..., n) the entry of each draw's own configuration (n,)."""
    return np.asarray(values[(*states, np.arange(values.shape[-1]))])


def _propose(
    belief: GroupBelief,
    table: Array,
    own: tuple[Index, ...],
    configurations: Index,
    frame: Frame,
    rng: np.random.Generator,
) -> tuple[dict[str, Array], Array]:
    """A point in a cell of the chart per draw, and its density over the cell's mean density."""
    chart = belief.chart(frame)
    shape = table.shape[len(own) :]
    cells = _choose(table.reshape(-1, np.prod(shape, dtype=int)), configurations, rng)
    index = np.unravel_index(cells, shape)
    points: dict[str, Array] = {}
    log_volume = np.zeros(len(cells))
    for name, i in zip(frame.axes, index, strict=True):
        low, high = _cell(chart.meshes[name], i)
        points[name] = low + (high - low) * rng.random(len(cells))
        log_volume += np.log(high - low)
    log_p, bases = _log_target(belief, points, own, frame)
    mass = table[(*own, *index)]
    with np.errstate(divide="ignore", over="ignore"):
        return {b: bases[b] for b in belief.group.bases}, np.exp(log_p - chart.log_scale + log_volume - np.log(mass))


def _choose(rows: Array, configurations: Index, rng: np.random.Generator) -> Index:
    """A cell per draw from the row of its configuration."""
    cells = np.empty(len(configurations), dtype=np.intp)
    for row in np.unique(configurations):
        here = configurations == row
        below = np.cumsum(rows[row])
        cells[here] = np.searchsorted(below, rng.random(int(here.sum())) * below[-1])
    return np.asarray(np.minimum(cells, rows.shape[-1] - 1))


def _cell(mesh: Mesh, index: Index) -> tuple[Array, Array]:
    middles = (mesh.nodes[1:] + mesh.nodes[:-1]) / 2
    bounds = np.concatenate([mesh.edges[:1], middles, mesh.edges[-1:]])
    return bounds[index], bounds[index + 1]


def _log_target(
    belief: GroupBelief, points: dict[str, Array], own: tuple[Index, ...], frame: Frame
) -> tuple[Array, dict[str, Array]]:
    """Log of the chart's integrand at points, and the values of all bases there."""
    group = belief.group
    values, log_p = frame.values(points)
    by_parent = dict(zip(group.parents, own, strict=True))
    for name, base_prior in group.bases.items():
        densities = base_prior.family.log_density(values[name])
        log_p = log_p + _own(densities, tuple(by_parent[p] for p in base_prior.parents))
    for name in belief.touched:
        x = values[name] if name in values else group.derived[name].formula.evaluate(values)
        log_p = log_p + belief.log_likelihood(name, x)
    return log_p, values
