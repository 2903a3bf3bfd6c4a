"""The belief about one property."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.information import entropy_bits

__all__ = ["Axis", "CategoricalMarginal", "ContinuousMarginal"]

Array = NDArray[np.float64]


class Axis(Protocol):
    """What a marginal is on: nodes, and how masses at them spread in between."""

    @property
    def nodes(self) -> Array:
        """(K,) ascending."""

    @property
    def weights(self) -> Array:
        """(K,): the integral of f is the sum of weights x f(nodes)."""

    def cumulative(self, masses: Array) -> tuple[Array, Array]:
        """Distribution function of masses (K,) at the edges and at the nodes."""

    def interleaved(self, at_edges: Array, at_nodes: Array, density: Array) -> tuple[Array, Array, Array]:
        """Points, distribution function and density at edges and nodes together, ascending."""

    def smooth(self, masses: Array) -> tuple[Array, Array]:
        """Values, ascending, and the density there, close enough to draw."""


@dataclass(frozen=True, eq=False)
class CategoricalMarginal:
    """Probabilities of the states of a property; they sum to one."""

    name: str
    states: tuple[str, ...]
    probabilities: Array

    @property
    def entropy_bits(self) -> float:
        """Entropy [bits]."""
        return entropy_bits(self.probabilities)


@dataclass(frozen=True, eq=False)
class ContinuousMarginal:
    """A density on a mesh.

    Parameters
    ----------
    masses
        Probability at each node of the mesh (K,); they sum to one.
    """

    name: str
    unit: str
    mesh: Axis
    masses: Array

    @property
    def nodes(self) -> Array:
        """Values of the property, ascending (K,) [unit]."""
        return self.mesh.nodes

    @cached_property
    def density(self) -> Array:
        """Density at the nodes (K,) [1/unit]."""
        return np.asarray(self.masses / self.mesh.weights)

    @property
    def curve(self) -> tuple[Array, Array]:
        """Values [unit], ascending, and the density there [1/unit], close enough to draw."""
        return self.mesh.smooth(self.masses)

    @cached_property
    def mean(self) -> float:
        """Mean [unit]."""
        return float(self.masses @ self.nodes)

    @cached_property
    def sd(self) -> float:
        """Standard deviation [unit]."""
        return float(np.sqrt(self.masses @ (self.nodes - self.mean) ** 2))

    @cached_property
    def entropy_bits(self) -> float:
        """Differential entropy for the unit stated [bits]."""
        p = np.maximum(self.density, np.finfo(float).tiny)
        return float(-(self.masses @ np.log2(p)))

    @cached_property
    def _cdf(self) -> tuple[Array, Array, Array]:
        """Points, distribution function and its slope there: at the panel edges and the nodes."""
        at_edges, at_nodes = self.mesh.cumulative(self.masses)
        points, below, slopes = self.mesh.interleaved(at_edges, at_nodes, self.density)
        return points, np.maximum.accumulate(np.clip(below, 0.0, 1.0)), slopes

    def cdf(self, x: float) -> float:
        """P(property <= x)."""
        points, below, slopes = self._cdf
        i = int(np.clip(np.searchsorted(points, x) - 1, 0, len(points) - 2))
        if not points[0] < x < points[-1]:
            return float(x >= points[-1])
        return _hermite(points, below, slopes, i, (x - points[i]) / (points[i + 1] - points[i]))

    def quantile(self, p: float) -> float:
        """The value below which the property lies with probability p [unit]."""
        points, below, slopes = self._cdf
        i = int(np.clip(np.searchsorted(below, p) - 1, 0, len(points) - 2))
        low, high = 0.0, 1.0
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (middle, high) if _hermite(points, below, slopes, i, middle) < p else (low, middle)
        return float(points[i] + (low + high) / 2 * (points[i + 1] - points[i]))


def _hermite(points: Array, values: Array, slopes: Array, i: int, t: float) -> float:
    """The cubic between points i and i + 1 with the given values and slopes, kept between the values."""
    h, a, b = points[i + 1] - points[i], float(values[i]), float(values[i + 1])
    # Slopes beyond three times the secant would make the cubic turn back.
    most = 3 * (b - a)
    da, db = min(h * slopes[i], most), min(h * slopes[i + 1], most)
    cubic = a + t * da + t * t * (3 * (b - a) - 2 * da - db) + t**3 * (2 * (a - b) + da + db)
    return float(min(max(cubic, a), b))
