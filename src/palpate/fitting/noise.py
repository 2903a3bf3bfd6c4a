"""The noise of a sensor of a number, from readings of objects whose true value is known.

The most likely SD, with a part in proportion to the true value and an offset shared by the readings of an object where
the template has them; readings beyond saturation are censored. First the noise is fitted with the heavy tails of
Student's t with 4 degrees of freedom (Lange, Little and Taylor 1989, Robust statistical modeling using the t
distribution); a reading is left out where not even one in twenty sets of so many has one so far out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import special

from palpate.fitting.data import Specimen
from palpate.fitting.likelihood import maximise
from palpate.fitting.parts import Bias, SensorPart
from palpate.fitting.readings import Readings, readings_of
from palpate.fitting.robust import FEWEST, LEAST, SURE, resolution
from palpate.network.sensors import NormalNoise, NumberSensor, StudentTNoise

__all__ = ["TOO_FEW", "fit_noise"]

Array = NDArray[np.float64]

TOO_FEW = 3
"""Readings that are no bounds: the fewest from which noise is estimated."""
HEAVY = 4.0
"""Degrees of freedom of the first fit."""
NORMAL_OVER_HEAVY = 1.2034
"""SD of normal noise over the scale that is fitted to it with these tails."""
PARTS = ("sd", "relative_sd", "offset_sd")
DIGITS = 6
NEGLIGIBLE = 1e-3
"""A part of the noise below this fraction of the whole is left away."""


def fit_noise(action: str, sensor: NumberSensor, specimens: Sequence[Specimen]) -> tuple[NumberSensor, SensorPart]:
    """Fit a sensor; it stays as it is where there are too few readings."""
    readings = readings_of(action, sensor, specimens)
    if int(readings.exact.sum()) < TOO_FEW or not np.any(_errors(readings)):
        return sensor, SensorPart(objects=len(readings.names), readings=len(readings.value))
    used = _plausible(sensor, readings)
    kept = readings.only(used)
    if not np.any(_errors(kept)):
        used, kept = np.ones_like(used), readings
    found, _ = _most_likely(sensor, kept, biased=False)
    part = SensorPart(
        objects=len(set(kept.thing.tolist())),
        readings=len(kept.value),
        saturated=int((~kept.exact).sum()),
        left_out=tuple(readings.names[thing] for thing in readings.thing[~used]),
        bias=_bias(sensor, kept),
    )
    return _rounded(found, kept), part


def _errors(readings: Readings) -> Array:
    """Readings that are no bounds, less the true values."""
    return np.asarray((readings.value - readings.truth)[readings.exact])


def _plausible(sensor: NumberSensor, readings: Readings) -> NDArray[np.bool_]:
    """Which readings are not too far from the truth."""
    count = int(readings.exact.sum())
    if count < FEWEST:
        return np.ones(len(readings.value), dtype=bool)
    heavy, bias = _most_likely(replace(sensor, noise=StudentTNoise(HEAVY), offset_sd=0.0), readings, biased=True)
    z = np.abs(readings.value - bias - readings.truth) / (heavy.scale(readings.truth) * NORMAL_OVER_HEAVY)
    if isinstance(sensor.noise, StudentTNoise):
        z = -special.ndtri(np.maximum(special.stdtr(sensor.noise.dof, -z * NORMAL_OVER_HEAVY), LEAST))
    odd = 2 * count * special.stdtr(count - 1, -z) < SURE
    return np.asarray(~(odd & readings.exact))


def _most_likely(sensor: NumberSensor, readings: Readings, *, biased: bool) -> tuple[NumberSensor, float]:
    """The sensor of the largest likelihood, and its bias, which is 0 unless it is fitted too."""
    parts = [name for name in PARTS if getattr(sensor, name) > 0]
    errors = _errors(readings)
    size = float(np.median(np.abs(errors)) or np.abs(errors).max())
    # readings tell no less noise than they are rounded by
    start, least = (_shared_out(noise, readings, parts) for noise in (size, resolution(errors)))
    first = float(np.median(errors)) if biased else 0.0

    def at(point: Array) -> tuple[NumberSensor, float]:
        scales = np.exp(np.clip(point[: len(parts)], -20, 20))
        values = {name: float(np.hypot(least[name], start[name] * s)) for name, s in zip(parts, scales, strict=True)}
        return _with_parts(sensor, values), first + size * float(point[-1]) if biased else 0.0

    def cost(point: Array) -> float:
        value = -_log_likelihood(*at(point), readings)
        return value if np.isfinite(value) else 1e300

    return at(maximise(cost, np.zeros(len(parts) + biased)))


def _log_likelihood(sensor: NumberSensor, bias: float, readings: Readings) -> float:
    if not sensor.offset_sd:
        return float(readings.log_likelihoods(sensor, bias).sum())
    if isinstance(sensor.noise, NormalNoise) and readings.exact.all():
        return _shared(sensor, bias, readings)
    return float(sum(sensor.log_likelihood(found, np.array([x]))[0] for x, found in readings.by_thing(bias)))


def _shared(sensor: NumberSensor, bias: float, readings: Readings) -> float:
    """As `NumberSensor.log_likelihood` in closed form, of all objects at once."""
    error, count = readings.value - bias - readings.truth, len(readings.names)
    precision = sensor.scale(readings.truth) ** -2.0
    total = np.bincount(readings.thing, precision, count)
    there = total > 0
    variance = 1 / total[there]
    mean = np.bincount(readings.thing, precision * error, count)[there] * variance
    wide = variance + sensor.offset_sd**2
    swap = 0.5 * mean**2 * (1 / variance - 1 / wide) + 0.5 * np.log(variance / wide)
    return float(readings.log_likelihoods(sensor, bias).sum() + swap.sum())


def _shared_out(noise: float, readings: Readings, parts: Sequence[str]) -> dict[str, float]:
    """Noise of a size shared evenly among its parts."""
    share = float(noise) / np.sqrt(len(parts))
    size = float(np.median(np.abs(readings.truth[readings.exact]))) or 1.0
    return {name: share / size if name == "relative_sd" else share for name in parts}


def _bias(sensor: NumberSensor, readings: Readings) -> Bias:
    """The bias, with the sandwich estimate of its standard error over objects (Liang and Zeger 1986)."""
    found, bias = _most_likely(sensor, readings, biased=True)
    whole = replace(found, offset_sd=0.0, sd=float(np.hypot(found.sd, found.offset_sd)))
    step = 1e-3 * float(np.median(whole.scale(readings.truth)))
    lower, middle, upper = (readings.log_likelihoods(whole, bias + shift) for shift in (-step, 0.0, step))
    slopes = np.bincount(readings.thing, (upper - lower) / (2 * step), len(readings.names))
    bend = float((upper - 2 * middle + lower).sum()) / step**2
    return Bias(float(bias), float(np.sqrt(np.sum(slopes**2)) / abs(bend)), float(found.sd))


def _rounded(sensor: NumberSensor, readings: Readings) -> NumberSensor:
    """The sensor without parts that are next to nothing."""
    values = {name: float(f"{getattr(sensor, name):.{DIGITS}g}") for name in PARTS}
    size = float(np.median(np.abs(readings.truth)))
    weight = {name: value * (size if name == "relative_sd" else 1.0) for name, value in values.items()}
    largest = max(weight.values())
    # an offset alone is no noise
    needed = max(("sd", "relative_sd"), key=lambda name: weight[name])
    kept = {name for name in PARTS if name == needed or weight[name] > NEGLIGIBLE * largest}
    return _with_parts(sensor, {name: value if name in kept else 0.0 for name, value in values.items()})


def _with_parts(sensor: NumberSensor, parts: Mapping[str, float]) -> NumberSensor:
    sd, relative_sd, offset_sd = (parts.get(name, getattr(sensor, name)) for name in PARTS)
    return replace(sensor, sd=sd, relative_sd=relative_sd, offset_sd=offset_sd)
