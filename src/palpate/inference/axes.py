"""The prior mesh of each continuous property: where its densities live and how finely they change."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from palpate.inference.mesh import Mesh, Pieces, split
from palpate.network.families import Family, StudentT, Uniform
from palpate.network.properties import ContinuousProperty, DerivedProperty

__all__ = ["ALONE", "base_mesh", "derived_mesh", "narrowed", "scale_given"]

Array = NDArray[np.float64]
Given = Callable[[Array], Array]

TAIL = 1e-9
"""Probability beyond the ends of a density as far as they are looked up: six SDs of a normal one."""
STRETCH = 5 / 3
"""A mesh reaches this much further from the median, where conflicting evidence may push: ten SDs."""
HEAVY_TAIL = 1e-7
"""The same for Student's t, whose far tail would make the mesh endless."""
CORE = 1e-7
"""Tail beyond which a density that is solved for need not be resolved given the others."""
KEPT = 1e-4
"""Tail of the others beyond which that holds too."""
KEPT_POINTS = 32
ALONE = 0.7
"""How much finer a property's mesh is where nothing else is integrated over with it."""
NARROW = 0.8
POLYNOMIAL = 0.5
"""How much finer a mesh is where noise is narrower than `NARROW` times the density's own scale."""
GIVEN = 0.6
"""How much finer a derived property's mesh is than its spread given the others."""
EDGED = 0.3
"""How much finer all meshes are where the input solved for is uniform: its ends fall within panels."""


def base_mesh(prior: ContinuousProperty, given: Given | None = None, noise: Given | None = None) -> Mesh:
    """The mesh for a property with densities of its own.

    Parameters
    ----------
    given
        The length over which the density changes at a point given the chart's other axes; None
        where there are none that make it narrower.
    noise
        Scale of the noise of the property's own sensors at a point; None where there are none.
    """
    family = prior.family
    middle = np.asarray(family.quantile(np.array(0.5))).ravel()
    lows, highs = middle + STRETCH * (_ends(family, HEAVY_TAIL if isinstance(family, StudentT) else TAIL) - middle)
    supports = np.stack([family.low, family.high]).reshape(2, -1)
    # A density begins at the end of its support where that is finite, and ends there.
    lows = np.where(np.isfinite(supports[0]), supports[0], lows)
    highs = np.minimum(highs, supports[1])
    finite = supports[np.isfinite(supports)]
    graded = bool(np.isfinite(supports[0]).any() and lows.min() == supports[0][np.isfinite(supports[0])].min())
    least = float(_ends(family, KEPT)[0].min())

    def scales(x: float) -> Array:
        own = np.broadcast_to(family.local_scale(x), family.low.shape).ravel()
        if given is None:
            return ALONE * (own if noise is None else narrowed(own, noise(np.array([x]))))
        other = given(np.array([max(x, least)]))[0]
        if noise is None:
            return np.asarray(np.minimum(own, other))
        # Under a narrow kernel it shows that prior and evidence together are sharper than each.
        both = 1 / np.hypot(1 / own, 1 / other)
        return np.asarray(np.minimum(narrowed(both, noise(np.array([x]))), np.minimum(own, other)))

    return split(
        Pieces(lows, highs, scales), float(lows.min()), float(highs.max()), graded, sorted(set(finite.tolist()))
    )


def narrowed(lengths: Array, noise: Array) -> Array:
    """Lengths to resolve, less where noise is narrower: kernels are then averaged over polynomials through nodes."""
    return np.asarray(np.where(noise < NARROW * lengths, POLYNOMIAL * lengths, lengths))


def _ends(family: Family, tail: float) -> Array:
    """Lower and upper quantiles of each configuration (2, configurations)."""
    return np.moveaxis(np.asarray(family.quantile(np.array([tail, 1 - tail]))), -1, 0).reshape(2, -1)


def derived_mesh(
    derived: DerivedProperty,
    solved: str,
    bases: Mapping[str, ContinuousProperty],
    parents: Sequence[str],
    noise: Given | None = None,
) -> Mesh:
    """The mesh for a derived property in a chart that solves for one of its inputs.

    Given the other inputs the derived property is as narrow as that input makes it: this, and not
    its own prior, is what the mesh has to resolve.
    """
    ends = _derived_ends(derived, bases, parents)
    supports = {name: float(bases[name].family.low.min()) for name in derived.formula.variables}
    floor = float(derived.formula.evaluate(supports)) if np.isfinite(list(supports.values())).all() else np.nan
    pieces = _pieces_given_others(derived, solved, bases, noise)
    if np.isfinite(floor) and floor <= ends[0]:
        return split(pieces, floor, ends[1], True)
    return split(pieces, ends[0], ends[1], False)


def _derived_ends(
    derived: DerivedProperty, bases: Mapping[str, ContinuousProperty], parents: Sequence[str]
) -> tuple[float, float]:
    """Ends beyond which next to nothing of the derived property lies."""
    names = derived.formula.variables
    values = _values(derived, bases, parents, np.array([TAIL, 1e-6, 0.5, 1 - 1e-6, 1 - TAIL]))
    grid = np.array(list(product(range(5), repeat=len(names))))
    # Corners beyond 1e-6 in two inputs at once are left out: they are rarer than TAIL by far.
    far = ((grid == 0) | (grid == 4)).sum(axis=1)
    near = ((grid == 1) | (grid == 3)).sum(axis=1)
    kept = values[:, (far == 0) | ((far == 1) & (near == 0))]
    return float(kept.min()), float(kept.max())


def _pieces_given_others(
    derived: DerivedProperty, solved: str, bases: Mapping[str, ContinuousProperty], noise: Given | None
) -> Pieces:
    family = bases[solved].family
    low, high = _ends(family, CORE)
    centre, scale = _centre_and_scale(family)
    others = [name for name in derived.formula.variables if name != solved]
    points = np.meshgrid(*(_spaced(*_kept_ends(bases[name].family)) for name in others), indexing="ij")
    given = {name: p.reshape(-1, 1) for name, p in zip(others, points, strict=True)}
    at = [derived.formula.evaluate({**given, solved: x}) for x in (low, high, centre - scale / 2, centre + scale / 2)]
    lows, highs = np.minimum(at[0], at[1]).ravel(), np.maximum(at[0], at[1]).ravel()
    scales = GIVEN * np.abs(at[3] - at[2]).ravel()
    if noise is None:
        return Pieces(lows, highs, lambda x: scales)
    return Pieces(lows, highs, lambda x: narrowed(scales, noise(np.array([x]))))


def scale_given(
    derived: DerivedProperty, solved: str, kept: str, bases: Mapping[str, ContinuousProperty], noise: Given
) -> Given:
    """The length over which p(kept | derived) changes: through the spread of the input solved for, and noise.

    Parameters
    ----------
    noise
        Scale of the evidence on the derived property, at values of it.
    """
    centre, spread = _centre_and_scale(bases[solved].family)
    others = {
        name: float(np.median(np.asarray(bases[name].family.quantile(np.array(0.5)))))
        for name in derived.formula.variables
        if name not in (solved, kept)
    }

    def scale(x: Array) -> Array:
        at = x[:, None]  # (X, configurations)
        step = 1e-4 * np.maximum(np.abs(at), 1e-6)
        value = derived.formula.evaluate({**others, kept: at, solved: centre})
        by_kept = (derived.formula.evaluate({**others, kept: at + step, solved: centre}) - value) / step
        by_solved = derived.formula.evaluate({**others, kept: at, solved: centre + spread / 2}) - value
        with np.errstate(divide="ignore", invalid="ignore"):
            length = np.hypot(2 * by_solved, noise(value)) / np.abs(by_kept)
        return np.asarray(np.where(np.isfinite(length), length, np.inf).min(axis=1))

    return scale


def _centre_and_scale(family: Family) -> tuple[Array, Array]:
    """Median and width of each configuration (configurations,)."""
    q16, centre, q84 = np.moveaxis(np.asarray(family.quantile(np.array([0.16, 0.5, 0.84]))), -1, 0).reshape(3, -1)
    own = np.array(
        [np.broadcast_to(family.local_scale(float(c)), family.low.shape).flat[k] for k, c in enumerate(centre)]
    )
    return centre, np.minimum(own, (q84 - q16) / 2) * (EDGED if isinstance(family, Uniform) else 1.0)


def _kept_ends(family: Family) -> tuple[float, float]:
    low, high = _ends(family, KEPT)
    return float(low.min()), float(high.max())


def _spaced(low: float, high: float) -> Array:
    """Points from low to high, in equal ratios where both are positive."""
    return np.geomspace(low, high, KEPT_POINTS) if low > 0 else np.linspace(low, high, KEPT_POINTS)


def _values(
    derived: DerivedProperty, bases: Mapping[str, ContinuousProperty], parents: Sequence[str], p: Array
) -> Array:
    """Values at all combinations of the inputs' quantiles p, (configurations, combinations)."""
    names = derived.formula.variables
    values: dict[str, Array] = {}
    for i, name in enumerate(names):
        q = np.asarray(bases[name].family.quantile(p))
        own = bases[name].parents
        # (own parents..., P) -> an axis per parent of the group, then an axis per input
        order = [x for x in parents if x in own]
        q = q.transpose([*(own.index(x) for x in order), q.ndim - 1])
        shape = [q.shape[order.index(x)] if x in own else 1 for x in parents]
        values[name] = q.reshape(*shape, *(p.size if j == i else 1 for j in range(len(names))))
    result = np.asarray(derived.formula.evaluate(values))
    cells = int(np.prod(result.shape[: len(parents)], dtype=int))
    return result.reshape(cells, p.size ** len(names))
