"""Families of densities in two coordinates that mean the same in each: a location and a spread.

Limits and degrees of freedom are no estimates: they are what the template says.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.network.families import Family, Gamma, LogNormal, Normal, StudentT

__all__ = ["FARTHEST", "Form", "form_of"]

Array = NDArray[np.float64]
Place = tuple[int, ...]

FARTHEST = 3.0
"""How many SDs a truncated normal's mean may lie beyond its limit.

Where values fall off as an exponential, or slower, the likelihood grows without end as the mean goes to minus infinity
(del Castillo 1994, The singly truncated normal distribution); at three SDs the density is nearly exponential.
"""


class Form(Protocol):
    """A family with two numbers to estimate."""

    def values(self, x: Array) -> Array:
        """Values as the coordinates measure them: their middle is near the location."""

    def settled(self, location: float, spread: float) -> tuple[float, float]:
        """The nearest coordinates that are allowed."""

    def parameters(self, location: float, spread: float) -> Mapping[str, float]:
        """The parameters in the network file."""

    def family(self, location: float, spread: float) -> Family:
        """One density."""


@dataclass(frozen=True)
class NormalForm:
    """Location and spread are mean and SD before truncation."""

    low: float
    high: float

    def values(self, x: Array) -> Array:
        """The values themselves."""
        return x

    def settled(self, location: float, spread: float) -> tuple[float, float]:
        """The mean not too far beyond the limits."""
        return float(np.clip(location, self.low - FARTHEST * spread, self.high + FARTHEST * spread)), spread

    def parameters(self, location: float, spread: float) -> Mapping[str, float]:
        """Mean and SD."""
        return {"mean": location, "sd": spread}

    def family(self, location: float, spread: float) -> Family:
        """A normal, truncated where there are limits."""
        return Normal(*(np.array(value) for value in (location, spread, self.low, self.high)))


@dataclass(frozen=True)
class LogNormalForm:
    """Location and spread are mean and SD of the logarithm."""

    def values(self, x: Array) -> Array:
        """Their logarithms."""
        return np.log(x)

    def settled(self, location: float, spread: float) -> tuple[float, float]:
        """All are allowed."""
        return location, spread

    def parameters(self, location: float, spread: float) -> Mapping[str, float]:
        """Median, and SD of the logarithm."""
        return {"median": float(np.exp(location)), "log_sd": spread}

    def family(self, location: float, spread: float) -> Family:
        """A lognormal."""
        return LogNormal(np.exp(np.array(location)), np.array(spread))


@dataclass(frozen=True)
class GammaForm:
    """Location is the logarithm of the mean, spread the SD divided by the mean."""

    def values(self, x: Array) -> Array:
        """Their logarithms."""
        return np.log(x)

    def settled(self, location: float, spread: float) -> tuple[float, float]:
        """All are allowed."""
        return location, spread

    def parameters(self, location: float, spread: float) -> Mapping[str, float]:
        """Shape and scale."""
        return {"shape": spread**-2.0, "scale": float(np.exp(location)) * spread**2}

    def family(self, location: float, spread: float) -> Family:
        """A gamma."""
        return Gamma(np.array(spread**-2.0), np.exp(np.array(location)) * spread**2)


@dataclass(frozen=True)
class StudentForm:
    """Location and scale."""

    dof: float

    def values(self, x: Array) -> Array:
        """The values themselves."""
        return x

    def settled(self, location: float, spread: float) -> tuple[float, float]:
        """All are allowed."""
        return location, spread

    def parameters(self, location: float, spread: float) -> Mapping[str, float]:
        """Location and scale."""
        return {"location": location, "scale": spread}

    def family(self, location: float, spread: float) -> Family:
        """Student's t."""
        return StudentT(np.array(location), np.array(spread), np.array(self.dof))


def form_of(family: Family, place: Place | None) -> Form | None:
    """The form of a family at a configuration of the parents, or None for all of them together.

    None is returned for a uniform: its limits are what is known, and no estimates.
    """
    if isinstance(family, Normal):
        if place is None:
            return NormalForm(float(family.low.min()), float(family.high.max()))
        return NormalForm(float(family.low[place]), float(family.high[place]))
    if isinstance(family, LogNormal):
        return LogNormalForm()
    if isinstance(family, Gamma):
        return GammaForm()
    if isinstance(family, StudentT):
        return StudentForm(float(np.median(family.dof) if place is None else family.dof[place]))
    return None
