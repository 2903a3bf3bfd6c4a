"""Number sensors on a dense grid of true values: likelihoods and the next reading's distribution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.network.noises import StudentTNoise
from palpate.network.sensors import NumberSensor
from tests.oracle import densities
from tests.oracle.evidence import Item
from tests.oracle.grids import walk

Array = NDArray[np.float64]


def _offsets(sensor: NumberSensor, items: Sequence[Item], x: Array) -> tuple[Array, Array]:
    """(offsets [O], ln weight [X, O] of offset and readings given x), the offset's prior included."""
    if not sensor.offset_sd:
        log_w = np.zeros((x.size, 1))
        for item in items:
            log_w = log_w + densities.log_term(sensor, item, x, densities.scale(sensor, x, item.get("sd")))[:, None]
        return np.zeros(1), log_w
    b = sensor.offset_sd
    least = min([b, *(float(densities.scale(sensor, x, i.get("sd")).min()) for i in items)])
    on = walk(-7.5 * b, 7.5 * b, lambda _: 1.5 * least)
    log_w = np.broadcast_to(-0.5 * (on.x / b) ** 2 - np.log(b * np.sqrt(2 * np.pi)) + np.log(on.w), (x.size, on.x.size))
    for item in items:
        scales = densities.scale(sensor, x, item.get("sd"))[:, None]
        log_w = log_w + densities.log_term(sensor, item, x[:, None] + on.x, scales)
    return on.x, log_w


def log_likelihood(sensor: NumberSensor, items: Sequence[Item], x: Array) -> Array:
    """Natural log of p(all readings of one object | x)."""
    _, log_w = _offsets(sensor, items, x)
    peak = log_w.max(axis=1, keepdims=True)
    peak = np.where(np.isfinite(peak), peak, 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(np.exp(log_w - peak).sum(axis=1)) + peak[:, 0])


@dataclass(frozen=True, eq=False)
class Outcomes:
    """The next reading: kernel [X, outcomes] of masses, and P(latent <= y), P(latent >= y) at one y."""

    kernel: Array
    tails: tuple[float, float]


def outcomes(
    sensor: NumberSensor,
    items: Sequence[Item],
    x: Array,
    mass: Array,
    refine: float,
    sd: float | None,
    at: float | None,
) -> Outcomes:
    """The next reading's distribution for true values x with posterior mass `mass`."""
    offsets, log_w = _offsets(sensor, items, x)
    weight = np.exp(log_w - log_w.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    scales = densities.scale(sensor, x, sd)

    def tail(bound: float, above: bool) -> Array:
        each = densities.tail(sensor, bound, x[:, None] + offsets, scales[:, None], above)
        return np.asarray((weight * each).sum(axis=1))

    if at is not None:
        share = mass / mass.sum()
        return Outcomes(np.empty((0, 0)), (float(share @ tail(at, False)), float(share @ tail(at, True))))
    y, w = _reading_grid(sensor, x, mass, scales, refine)
    kernel = np.zeros((x.size, y.size))
    for o, shift in enumerate(offsets):
        centre = (x + shift)[:, None]
        kernel += weight[:, o, None] * densities.density(sensor, y, centre, scales[:, None]) * w
    ends = ((sensor.low, False), (sensor.high, True))
    atoms = [tail(bound, above) for bound, above in ends if np.isfinite(bound)]
    return Outcomes(np.column_stack([kernel, *atoms]), (np.nan, np.nan))


def _reading_grid(sensor: NumberSensor, x: Array, mass: Array, scales: Array, refine: float) -> tuple[Array, Array]:
    """Nodes and weights of readings, from the far tail on one side to that on the other."""
    on = mass > 1e-14 * mass.sum()
    near, wide = x[on], np.hypot(scales[on], sensor.offset_sd)
    heavy = isinstance(sensor.noise, StudentTNoise)
    reach = (1e3 if heavy else 9.5) * wide
    low, high = float((near - reach).min()), float((near + reach).max())
    order = np.argsort(x)

    def step(y: float) -> float:
        local = float(np.interp(y, x[order], scales[order]))
        beyond = max(0.0, near.min() - y, y - near.max())
        return refine * (3 * local + (beyond if heavy else 0.0))

    found = walk(max(low, sensor.low), min(high, sensor.high), step)
    return found.x, found.w
