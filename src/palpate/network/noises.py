"""Noise of number sensors: its forms, and mixtures of it about true values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import special

__all__ = ["Kernel", "Noise", "NormalNoise", "StudentTNoise", "offset_nodes"]

Array = NDArray[np.float64]
HALF_LOG_2_PI = float(0.5 * np.log(2 * np.pi))


class Noise(Protocol):
    """The form of a number sensor's noise, for a standardised residual z."""

    def log_density(self, z: Array) -> Array:
        """Natural log of the density of z."""

    def cdf(self, z: Array) -> Array:
        """P(Z <= z)."""

    def log_cdf(self, z: Array) -> Array:
        """Natural log of `cdf`, exact far in the tail."""

    def draw(self, rng: np.random.Generator) -> float:
        """One residual."""


@dataclass(frozen=True)
class NormalNoise:
    """Normal noise; the scale is its SD."""

    def log_density(self, z: Array) -> Array:
        return np.asarray(-0.5 * z * z - HALF_LOG_2_PI)

    def cdf(self, z: Array) -> Array:
        return np.asarray(special.ndtr(z))

    def log_cdf(self, z: Array) -> Array:
        return np.asarray(special.log_ndtr(z))

    def draw(self, rng: np.random.Generator) -> float:
        return float(rng.standard_normal())


@dataclass(frozen=True)
class StudentTNoise:
    """Heavy-tailed noise: Student's t with `dof` degrees of freedom; the scale is not its SD."""

    dof: float

    def log_density(self, z: Array) -> Array:
        dof = self.dof
        constant = special.gammaln((dof + 1) / 2) - special.gammaln(dof / 2) - 0.5 * np.log(dof * np.pi)
        return np.asarray(constant - (dof + 1) / 2 * np.log1p(z * z / dof))

    def cdf(self, z: Array) -> Array:
        return np.asarray(special.stdtr(self.dof, z))

    def log_cdf(self, z: Array) -> Array:
        return np.asarray(np.log(special.stdtr(self.dof, z)))

    def draw(self, rng: np.random.Generator) -> float:
        return float(rng.standard_t(self.dof))


@dataclass(frozen=True, eq=False)
class Kernel:
    """p(next reading | true value, readings so far): noise about shifted values, a mixture.

    Shapes below: x true values (X,), y readings (Y,). There are (X, O) mixture terms, O = 1 unless
    an offset shared by repetitions had to be integrated numerically.
    """

    noise: Noise
    centre: Array  # (X, O)
    scale: Array  # (X, O)
    weight: Array  # (X, O), rows sum to one

    def _mix(self, values: Array) -> Array:
        if values.shape[1] == 1:
            return values[:, 0]
        return np.asarray((values * self.weight[:, :, None]).sum(axis=1))

    def density(self, y: Array) -> Array:
        """(X, Y), per unit of y."""
        z = (y - self.centre[:, :, None]) / self.scale[:, :, None]
        return self._mix(np.exp(self.noise.log_density(z)) / self.scale[:, :, None])

    def cdf(self, y: Array) -> Array:
        """P(reading <= y), (X, Y), before saturation."""
        return self._mix(self.noise.cdf((y - self.centre[:, :, None]) / self.scale[:, :, None]))

    def survival(self, y: Array) -> Array:
        """P(reading >= y), (X, Y), before saturation; exact where it is small."""
        return self._mix(self.noise.cdf((self.centre[:, :, None] - y) / self.scale[:, :, None]))


def offset_nodes(offset_sd: float, least: float) -> tuple[Array, Array]:
    """Values of an offset N(0, offset_sd^2) and their probabilities, fine enough for noise of scale `least`."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    panels = int(np.clip(np.ceil(16 * offset_sd / (2 * max(min(least, offset_sd), 1e-9))), 8, 400))
    edges = np.linspace(-8 * offset_sd, 8 * offset_sd, panels + 1)
    half = (edges[1] - edges[0]) / 2
    offsets = ((edges[:-1] + half)[:, None] + half * nodes).ravel()
    weight = np.exp(-0.5 * (offsets / offset_sd) ** 2) * np.tile(weights * half, panels)
    return offsets, weight / weight.sum()
