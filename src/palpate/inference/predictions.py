"""The distribution of an action's outcome before it is taken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.network.noises import Kernel

__all__ = ["LabelPrediction", "NumberPrediction"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LabelPrediction:
    """Probabilities of the labels; they sum to one."""

    outcomes: tuple[str, ...]
    probabilities: Array


@dataclass(frozen=True, eq=False)
class NumberPrediction:
    """A reading's density between the ends at which the sensor saturates, and an atom at each end.

    Parameters
    ----------
    masses
        Probability of each true value the kernel is given for; they sum to one.
    """

    kernel: Kernel
    masses: Array
    low: float
    high: float

    def density(self, y: Array | float) -> Array:
        """Density of readings y per unit; zero where the sensor saturates."""
        flat = np.ravel(np.asarray(y, float))
        inside = (flat >= self.low) & (flat <= self.high)
        # Masses spread over finer nodes can be below zero by the error of the panels' polynomials.
        density = np.maximum(self.masses @ self.kernel.density(flat), 0.0)
        return np.asarray(np.where(inside, density, 0.0)).reshape(np.shape(y))

    def cdf(self, y: Array | float) -> Array:
        """P(reading <= y), `below` counted as `low`; one only beyond `high`."""
        flat = np.ravel(np.asarray(y, float))
        below = self.masses @ self.kernel.cdf(flat)
        below = np.where(flat < self.low, 0.0, np.where(flat > self.high, 1.0, below))
        return np.asarray(below).reshape(np.shape(y))

    @property
    def below(self) -> float:
        """Probability that the reading saturates at the low end."""
        return float(self.masses @ self.kernel.cdf(np.array([self.low]))[:, 0]) if np.isfinite(self.low) else 0.0

    @property
    def above(self) -> float:
        """Probability that the reading saturates at the high end."""
        return float(self.masses @ self.kernel.survival(np.array([self.high]))[:, 0]) if np.isfinite(self.high) else 0.0
