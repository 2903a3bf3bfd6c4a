"""The most likely location and spread of values, of some of which only the side is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from palpate.fitting.forms import Form

__all__ = ["LOG_SD", "Prior", "Sample", "maximise", "most_likely"]

Array = NDArray[np.float64]

LOG_SD = 0.5
"""SD of the logarithm of a spread about that of the others: two thirds are within a factor of 1.65."""
TINY = 1e-300


@dataclass(frozen=True)
class Sample:
    """Values of one configuration.

    Attributes
    ----------
    inner
        Values that are known (n,).
    below, above
        How many more lie below the least and above the largest of these.
    """

    inner: Array
    below: int = 0
    above: int = 0

    def log_likelihood(self, form: Form, location: float, spread: float) -> float:
        """Natural log of the density of all values."""
        family = form.family(location, spread)
        total = float(family.log_density(self.inner).sum())
        if self.below or self.above:
            low, high = family.cdf(self.inner[[0, -1]])
            total += self.below * np.log(max(low, TINY)) + self.above * np.log(max(1 - high, TINY))
        return float(total)


@dataclass(frozen=True)
class Prior:
    """What all values say of the location and the spread of some.

    Normal in the location, and in the logarithm of the spread.
    """

    location: float
    location_sd: float
    spread: float

    def log_density(self, location: float, spread: float) -> float:
        """Natural log, up to a constant."""
        z = (location - self.location) / self.location_sd, np.log(spread / self.spread) / LOG_SD
        return float(-0.5 * (z[0] ** 2 + z[1] ** 2))


def most_likely(
    form: Form, sample: Sample, start: tuple[float, float], floor: float, prior: Prior | None = None
) -> tuple[float, float]:
    """Location and spread of the largest likelihood, times the prior where there is one.

    Parameters
    ----------
    start
        Location and spread to begin with.
    floor
        Least spread.
    """
    middle, unit = start

    def at(point: Array) -> tuple[float, float, float]:
        # in quadrature: beyond a sharp limit all costs would be the same, and the search lost
        spread = float(np.hypot(floor, unit * np.exp(np.clip(point[1], -30, 30))))
        location = middle + unit * float(point[0])
        inside, spread = form.settled(location, spread)
        return inside, spread, abs(location - inside) / spread

    def cost(point: Array) -> float:
        location, spread, beyond = at(point)
        value = sample.log_likelihood(form, location, spread) - beyond
        if prior is not None:
            value += prior.log_density(location, spread)
        return -value if np.isfinite(value) else 1e300

    location, spread, _ = at(maximise(cost, np.zeros(2)))
    return location, spread


def maximise(cost: Callable[[Array], float], start: Array) -> Array:
    """The point of least cost, by the simplex of Nelder and Mead (1965)."""
    simplex = np.vstack([start, start + 0.5 * np.eye(len(start))])
    options = {"initial_simplex": simplex, "xatol": 1e-5, "fatol": 1e-8, "maxfev": 2000}
    return np.asarray(optimize.minimize(cost, start, method="Nelder-Mead", options=options).x)
