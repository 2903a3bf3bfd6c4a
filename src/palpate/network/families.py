"""Families of prior densities for continuous properties, one member per parent configuration.

Parameters are arrays of one shape, `config` below: an axis per parent, empty for a property
without parents. Every method puts the axes of its argument behind those of `config`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import special

__all__ = ["Family", "Gamma", "LogNormal", "Normal", "StudentT", "Uniform"]

Array = NDArray[np.float64]
LOG_SQRT_2PI = 0.5 * np.log(2 * np.pi)


def _lift(parameter: Array, x: Array) -> Array:
    """Append as many axes to the parameter as x has, so that they broadcast."""
    return np.reshape(parameter, np.shape(parameter) + (1,) * np.ndim(x))


def _lighter_side(a: Array, b: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The interval [a, b] of a standard normal, mirrored where it lies above zero: no cancellation there."""
    flip = a > 0
    return np.where(flip, -b, a), np.where(flip, -a, b), flip


def _log_normal_mass(a: Array, b: Array) -> Array:
    """Natural log of P(a <= Z <= b) of a standard normal, exact far in the tails; -inf where b <= a."""
    lower, upper, _ = _lighter_side(a, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        log_lower, log_upper = special.log_ndtr(lower), special.log_ndtr(upper)
        log_mass = log_upper + np.log1p(-np.exp(log_lower - log_upper))
    return np.where(upper > lower, log_mass, -np.inf)


class Family(Protocol):
    """Densities p(x | configuration) that share a form."""

    @property
    def low(self) -> Array:
        """Lower end of the support, `config` shape."""

    @property
    def high(self) -> Array:
        """Upper end of the support, `config` shape."""

    def log_density(self, x: Array) -> Array:
        """Natural log of the density at x [config..., x...]; -inf outside the support."""

    def cdf(self, x: Array) -> Array:
        """P(X <= x) [config..., x...]."""

    def quantile(self, p: Array) -> Array:
        """The inverse of `cdf` [config..., p...]."""

    def local_scale(self, x: float) -> Array:
        """The length over which each density changes its form near x [config...]."""


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal with the mean and SD it has before truncation to [low, high]."""

    mean: Array
    sd: Array
    low: Array
    high: Array

    @property
    def _ends(self) -> tuple[Array, Array]:
        return (self.low - self.mean) / self.sd, (self.high - self.mean) / self.sd

    def log_density(self, x: Array) -> Array:
        z = (x - _lift(self.mean, x)) / _lift(self.sd, x)
        log_p = -0.5 * z * z - _lift(np.log(self.sd) + LOG_SQRT_2PI + _log_normal_mass(*self._ends), x)
        inside = (x >= _lift(self.low, x)) & (x <= _lift(self.high, x))
        return np.where(inside, log_p, -np.inf)

    def cdf(self, x: Array) -> Array:
        a, b = self._ends
        z = np.clip((x - _lift(self.mean, x)) / _lift(self.sd, x), _lift(a, x), _lift(b, x))
        return np.exp(_log_normal_mass(_lift(a, x), z) - _lift(_log_normal_mass(a, b), x))

    def quantile(self, p: Array) -> Array:
        a, b = (_lift(end, p) for end in self._ends)
        lower, upper, flip = _lighter_side(a, b)
        share = np.where(flip, 1 - p, p)
        with np.errstate(divide="ignore"):
            low, high = np.log1p(-share) + special.log_ndtr(lower), np.log(share) + special.log_ndtr(upper)
        z = special.ndtri_exp(np.logaddexp(low, high))
        return np.asarray(_lift(self.mean, p) + _lift(self.sd, p) * np.clip(np.where(flip, -z, z), a, b))

    def local_scale(self, x: float) -> Array:
        return self.sd


@dataclass(frozen=True, eq=False)
class LogNormal:
    """exp of a normal with mean log(median) and SD log_sd."""

    median: Array
    log_sd: Array

    @property
    def low(self) -> Array:
        return np.zeros_like(self.median)

    @property
    def high(self) -> Array:
        return np.full_like(self.median, np.inf)

    def _z(self, x: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.log(np.maximum(x, 0) / _lift(self.median, x)) / _lift(self.log_sd, x))

    def log_density(self, x: Array) -> Array:
        z = self._z(x)
        with np.errstate(divide="ignore", invalid="ignore"):
            log_p = -0.5 * z * z - np.log(np.maximum(x, 0)) - _lift(np.log(self.log_sd) + LOG_SQRT_2PI, x)
        return np.where(np.broadcast_to(x, log_p.shape) > 0, log_p, -np.inf)

    def cdf(self, x: Array) -> Array:
        return np.asarray(special.ndtr(self._z(x)))

    def quantile(self, p: Array) -> Array:
        return np.asarray(_lift(self.median, p) * np.exp(_lift(self.log_sd, p) * special.ndtri(p)))

    def local_scale(self, x: float) -> Array:
        least = self.median * np.exp(-5 * self.log_sd)
        return np.asarray(np.maximum(x, least) * np.minimum(self.log_sd, 1.0))


@dataclass(frozen=True, eq=False)
class Gamma:
    """Gamma with the given shape (no unit) and scale (the property's unit)."""

    shape: Array
    scale: Array

    @property
    def low(self) -> Array:
        return np.zeros_like(self.shape)

    @property
    def high(self) -> Array:
        return np.full_like(self.shape, np.inf)

    def log_density(self, x: Array) -> Array:
        shape, t = _lift(self.shape, x), np.maximum(x, 0) / _lift(self.scale, x)
        log_p = special.xlogy(shape - 1, t) - t - special.gammaln(shape) - np.log(_lift(self.scale, x))
        return np.where(np.broadcast_to(x, log_p.shape) >= 0, log_p, -np.inf)

    def cdf(self, x: Array) -> Array:
        return np.asarray(special.gammainc(_lift(self.shape, x), np.maximum(x, 0) / _lift(self.scale, x)))

    def quantile(self, p: Array) -> Array:
        return np.asarray(_lift(self.scale, p) * special.gammaincinv(_lift(self.shape, p), p))

    def local_scale(self, x: float) -> Array:
        # Near zero x^(shape-1) changes over x itself; in the body and the tail over the SD.
        sd = self.scale * np.sqrt(self.shape)
        return np.asarray(np.minimum(sd, np.maximum(x, 0.05 * sd)))


@dataclass(frozen=True, eq=False)
class Uniform:
    """Uniform between low and high."""

    low: Array
    high: Array

    def log_density(self, x: Array) -> Array:
        inside = (x >= _lift(self.low, x)) & (x <= _lift(self.high, x))
        return np.where(inside, -np.log(_lift(self.high - self.low, x)), -np.inf)

    def cdf(self, x: Array) -> Array:
        low, high = _lift(self.low, x), _lift(self.high, x)
        return np.asarray(np.clip((x - low) / (high - low), 0.0, 1.0))

    def quantile(self, p: Array) -> Array:
        return np.asarray(_lift(self.low, p) + _lift(self.high - self.low, p) * p)

    def local_scale(self, x: float) -> Array:
        return np.asarray((self.high - self.low) / 4)


@dataclass(frozen=True, eq=False)
class StudentT:
    """Student's t with a location, a scale (not an SD) and degrees of freedom."""

    location: Array
    scale: Array
    dof: Array

    @property
    def low(self) -> Array:
        return np.full_like(self.location, -np.inf)

    @property
    def high(self) -> Array:
        return np.full_like(self.location, np.inf)

    def log_density(self, x: Array) -> Array:
        dof = _lift(self.dof, x)
        t = (x - _lift(self.location, x)) / _lift(self.scale, x)
        constant = special.gammaln((dof + 1) / 2) - special.gammaln(dof / 2) - 0.5 * np.log(dof * np.pi)
        return np.asarray(constant - (dof + 1) / 2 * np.log1p(t * t / dof) - np.log(_lift(self.scale, x)))

    def cdf(self, x: Array) -> Array:
        return np.asarray(special.stdtr(_lift(self.dof, x), (x - _lift(self.location, x)) / _lift(self.scale, x)))

    def quantile(self, p: Array) -> Array:
        return np.asarray(_lift(self.location, p) + _lift(self.scale, p) * special.stdtrit(_lift(self.dof, p), p))

    def local_scale(self, x: float) -> Array:
        return np.asarray(np.hypot(self.scale, 0.3 * (x - self.location)))
