"""The noise of a sensor of a number, from readings of objects whose true value is known.

The most likely SD, with a part in proportion to the true value where the template has one, and an offset shared by the
readings of an object and a bias where it has them or they are asked for; readings beyond saturation are censored. First
the noise is fitted with the heavy tails of Student's t with 4 degrees of freedom (Lange, Little and Taylor 1989, Robust
statistical modeling using the t distribution); a reading is left out where not even one in twenty sets of so many has
one so far out.
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
from palpate.fitting.shared_offsets import log_likelihood
from palpate.network.noises import StudentTNoise
from palpate.network.sensors import NumberSensor

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


def fit_noise(
    action: str, sensor: NumberSensor, specimens: Sequence[Specimen], *, whole: bool = False
) -> tuple[NumberSensor, SensorPart]:
    """Fit a sensor; it stays as it is where there are too few readings.

    Parameters
    ----------
    whole
        Whether its bias, its saturation and an offset that the readings of an object share are estimated too, where
        the readings tell of them; otherwise a bias and an offset are only where the sensor has one.
    """
    readings = readings_of(action, sensor, specimens)
    if int(readings.exact.sum()) < TOO_FEW or not np.any(_errors(readings)):
        return sensor, SensorPart(objects=len(readings.names), readings=len(readings.value))
    bare = replace(sensor, bias=0.0)
    if whole:
        bare = replace(_saturating(bare, readings), offset_sd=sensor.offset_sd or _first_offset(readings))
    used = _plausible(bare, readings)
    kept = readings.only(used)
    if not np.any(_errors(kept)):
        used, kept = np.ones_like(used), readings
    biased, shift = _most_likely(bare, kept, biased=True)
    bias = _bias(biased, shift, kept)
    if (whole or sensor.bias) and abs(shift) > bias.se:
        found = replace(biased, bias=float(f"{shift:.{DIGITS}g}"))
    else:
        found, _ = _most_likely(bare, kept, biased=False)
    part = SensorPart(
        objects=len(set(kept.thing.tolist())),
        readings=len(kept.value),
        saturated=int((~kept.exact).sum()),
        left_out=tuple(readings.names[thing] for thing in readings.thing[~used]),
        bias=bias,
    )
    return _rounded(found, kept), part


def _saturating(sensor: NumberSensor, readings: Readings) -> NumberSensor:
    """The sensor with the limits that its bounds tell: where all are the same, and no reading is beyond."""
    exact, found = readings.value[readings.exact], sensor
    above, below = (np.unique(readings.value[readings.side == side]) for side in (1.0, -1.0))
    if len(above) == 1 and np.all(exact <= above[0]):
        found = replace(found, high=float(above[0]))
    if len(below) == 1 and np.all(exact >= below[0]):
        found = replace(found, low=float(below[0]))
    return found


def _first_offset(readings: Readings) -> float:
    """An offset to begin the search with; none where too few objects were read more than once."""
    several = np.bincount(readings.thing[readings.exact], minlength=len(readings.names)) > 1
    return float(np.abs(_errors(readings)).max()) if int(several.sum()) >= TOO_FEW else 0.0


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
    if sensor.offset_sd:
        return log_likelihood(sensor, bias, readings)
    return float(readings.log_likelihoods(sensor, bias).sum())


def _shared_out(noise: float, readings: Readings, parts: Sequence[str]) -> dict[str, float]:
    """Noise of a size shared evenly among its parts."""
    share = float(noise) / np.sqrt(len(parts))
    size = float(np.median(np.abs(readings.truth[readings.exact]))) or 1.0
    return {name: share / size if name == "relative_sd" else share for name in parts}


def _bias(found: NumberSensor, bias: float, readings: Readings) -> Bias:
    """The bias, with the sandwich estimate of its standard error over objects (Liang and Zeger 1986)."""
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
