"""Densities on a regular grid, integrated by the trapezoid rule."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from palpate.information import sum_p_log_p

__all__ = ["Grid"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Grid:
    """A regular grid, the axis of a marginal.

    Densities f below are values at the nodes (K,) [1/unit] and need not integrate to one.

    Parameters
    ----------
    nodes
        (K,) ascending, equally far apart.
    """

    nodes: Array

    @classmethod
    def regular(cls, low: float, high: float, step: float) -> Self:
        """Nodes from `low` to at most `high`, `step` apart.

        Examples
        --------
        >>> Grid.regular(-1.0, 1.2, 0.5).nodes.tolist()
        [-1.0, -0.5, 0.0, 0.5, 1.0]
        """
        # a top that is a whole number of steps away is reached, rounding or not
        nodes = low + step * np.arange(int((high - low) / step + 1e-9) + 1)
        return cls(np.asarray(nodes, float))

    # -- what a marginal asks of its axis ---------------------------------------------------

    @cached_property
    def weights(self) -> Array:
        """Weights of the trapezoid rule (K,)."""
        steps = np.diff(self.nodes)
        return np.asarray((np.append(steps, 0.0) + np.append(0.0, steps)) / 2)

    @property
    def size(self) -> int:
        """Number of nodes K."""
        return len(self.nodes)

    def cumulative(self, masses: Array) -> tuple[Array, Array]:
        """Distribution function of masses (K,) at the edges and at the nodes: nodes are edges here."""
        density, step = masses / self.weights, self.nodes[1] - self.nodes[0]
        below = np.append(0.0, np.cumsum(step * (density[1:] + density[:-1]) / 2))
        # Between the ends the trapezoid rule errs by what the slope adds (Euler-Maclaurin).
        slope = np.gradient(density, step)
        below = below - step**2 / 12 * (slope - slope[0])
        return below, below

    def interleaved(self, at_edges: Array, at_nodes: Array, density: Array) -> tuple[Array, Array, Array]:
        """Points, distribution function and density, ascending."""
        return self.nodes, at_nodes, density

    def smooth(self, masses: Array) -> tuple[Array, Array]:
        """Values and the density there: the grid is fine enough to draw as it is."""
        return self.nodes, np.asarray(masses / self.weights)

    # -- what the engine asks of it ---------------------------------------------------------

    @property
    def middle(self) -> float:
        """The middle of the axis."""
        return float((self.nodes[0] + self.nodes[-1]) / 2)

    def integral(self, f: Array) -> float:
        """The integral of f over the axis."""
        return float(self.weights @ f)

    def masses(self, f: Array) -> Array:
        """Probability at the nodes (K,); they sum to one."""
        masses = self.weights * f
        return np.asarray(masses / masses.sum())

    def entropy_bits(self, f: Array) -> float:
        """The integral of -f log2 f [bits], for the unit of the axis; f is taken as it is.

        Examples
        --------
        >>> grid = Grid.regular(0.0, 4.0, 0.5)
        >>> round(grid.entropy_bits(np.full(9, 0.25)), 12)
        2.0
        """
        # -∫ f ln f = -Σ m ln m + Σ m ln w for masses m = w f
        masses = self.weights * f
        nats = -sum_p_log_p(masses) + float(masses @ np.log(self.weights))
        return nats / float(np.log(2))

    def blurred(self, f: Array, sd: float) -> Array:
        """f convolved with a normal of that SD, by fast Fourier transform; it integrates to one.

        The kernel lives on the same axis about its middle, cut to a whole number as in the released
        program, and the middle part of the convolution is kept.
        """
        size, start = self.size, (self.size - 1) // 2
        kernel = np.exp(-0.5 * ((self.nodes - int(self.middle)) / sd) ** 2)
        # twice the length, so that the ends do not wrap around
        spectrum = np.fft.rfft(f, 2 * size) * np.fft.rfft(kernel, 2 * size)
        full = np.fft.irfft(spectrum, 2 * size)[start : start + size]
        blurred = np.maximum(full, 0.0)  # rounding leaves numbers just below zero
        return np.asarray(blurred / self.integral(blurred))

    def draw(self, f: Array, n: int, rng: np.random.Generator) -> Array:
        """n nodes, drawn in proportion to f (n,)."""
        return np.asarray(rng.choice(self.nodes, size=n, p=f / f.sum()))
