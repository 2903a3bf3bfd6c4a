"""Log densities of priors and sensors, written here anew so that the oracle shares no code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from palpate.network.families import Family, Gamma, LogNormal, Normal, StudentT, Uniform
from palpate.network.noises import StudentTNoise
from palpate.network.sensors import NumberSensor

Array = NDArray[np.float64]
Density = Callable[[Array], Array]


def _frozen(family: Family, index: int) -> Any:
    def at(name: str) -> float:
        return float(np.ravel(getattr(family, name))[index])

    if isinstance(family, LogNormal):
        return stats.lognorm(s=at("log_sd"), scale=at("median"))
    if isinstance(family, Gamma):
        return stats.gamma(a=at("shape"), scale=at("scale"))
    if isinstance(family, Uniform):
        return stats.uniform(at("low"), at("high") - at("low"))
    assert isinstance(family, StudentT)
    return stats.t(df=at("dof"), loc=at("location"), scale=at("scale"))


def prior(family: Family, index: int) -> Density:
    """Log density of the family's member with this flat configuration index."""
    if not isinstance(family, Normal):
        frozen = _frozen(family, index)
        return lambda x: np.asarray(frozen.logpdf(x))
    mean, sd, low, high = (float(np.ravel(p)[index]) for p in (family.mean, family.sd, family.low, family.high))
    if low > mean:  # the mass from the side where it does not cancel
        mass = stats.norm.sf(low, mean, sd) - stats.norm.sf(high, mean, sd)
    else:
        mass = stats.norm.cdf(high, mean, sd) - stats.norm.cdf(low, mean, sd)
    constant = -np.log(sd * np.sqrt(2 * np.pi) * mass)

    def log_density(x: Array) -> Array:
        value = constant - (x - mean) ** 2 / (2 * sd * sd)
        return np.where((x < low) | (x > high), -np.inf, value)

    return log_density


def scale(sensor: NumberSensor, x: Array, sd: float | None) -> Array:
    """Scale of the sensor's noise at true values x."""
    if sd is not None:
        return np.full(x.shape, sd)
    return np.sqrt(sensor.sd**2 + (sensor.relative_sd * x) ** 2)


def _noise(sensor: NumberSensor) -> Any:
    return stats.t(df=sensor.noise.dof) if isinstance(sensor.noise, StudentTNoise) else stats.norm


def log_term(sensor: NumberSensor, item: Mapping[str, Any], centre: Array, scales: Array) -> Array:
    """Log likelihood of one reading or bound for noise about `centre`."""
    noise = _noise(sensor)
    if "value" in item:
        return np.asarray(noise.logpdf((item["value"] - centre) / scales) - np.log(scales))
    if "above" in item:
        return np.asarray(noise.logsf((item["above"] - centre) / scales))
    return np.asarray(noise.logcdf((item["below"] - centre) / scales))


def density(sensor: NumberSensor, y: Array, centre: Array, scales: Array) -> Array:
    """Density of readings y for noise about `centre`."""
    z = (y - centre) / scales
    if isinstance(sensor.noise, StudentTNoise):
        dof = sensor.noise.dof
        top = float(stats.t.pdf(0.0, dof))
        return np.asarray(top * (1 + z * z / dof) ** (-(dof + 1) / 2) / scales)
    return np.asarray(np.exp(-0.5 * z * z) / (np.sqrt(2 * np.pi) * scales))


def tail(sensor: NumberSensor, bound: float, centre: Array, scales: Array, above: bool) -> Array:
    """P(latent reading above, or below, the bound)."""
    z = (bound - centre) / scales
    return np.asarray(_noise(sensor).sf(z) if above else _noise(sensor).cdf(z))
