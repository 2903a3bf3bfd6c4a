"""How likely readings are whose noise has a part that all readings of an object share, of all objects at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import special

from palpate.fitting.readings import Readings
from palpate.network.noises import NormalNoise, offset_nodes
from palpate.network.sensors import NumberSensor

__all__ = ["log_likelihood"]

Array = NDArray[np.float64]


def log_likelihood(sensor: NumberSensor, bias: float, readings: Readings) -> float:
    """Natural log of the likelihood, as the sum over objects of `NumberSensor.log_likelihood`.

    Objects without bounds have a closed form where the noise is normal; of the others the offset is integrated.
    """
    bounded = np.zeros(len(readings.names), dtype=bool)
    bounded[readings.thing[~readings.exact]] = True
    closed = ~bounded[readings.thing] & isinstance(sensor.noise, NormalNoise)
    total = _closed(sensor, bias, readings.only(closed)) if closed.any() else 0.0
    return total + (_integrated(sensor, bias, readings.only(~closed)) if not closed.all() else 0.0)


def _closed(sensor: NumberSensor, bias: float, readings: Readings) -> float:
    error, count = readings.value - bias - readings.truth, len(readings.names)
    precision = sensor.scale(readings.truth) ** -2.0
    total = np.bincount(readings.thing, precision, count)
    there = total > 0
    variance = 1 / total[there]
    mean = np.bincount(readings.thing, precision * error, count)[there] * variance
    wide = variance + sensor.offset_sd**2
    swap = 0.5 * mean**2 * (1 / variance - 1 / wide) + 0.5 * np.log(variance / wide)
    return float(readings.log_likelihoods(sensor, bias).sum() + swap.sum())


def _integrated(sensor: NumberSensor, bias: float, readings: Readings) -> float:
    offsets, weight = offset_nodes(sensor.offset_sd, float(sensor.scale(readings.truth).min()))
    terms = np.array([readings.log_likelihoods(sensor, bias + offset) for offset in offsets.tolist()])  # (offsets, n)
    things, place = np.unique(readings.thing, return_inverse=True)
    of_thing = np.zeros((len(things), len(offsets)))
    np.add.at(of_thing, place, terms.T)
    return float(special.logsumexp(of_thing + np.log(weight), axis=1).sum())
