"""What a gap read in steps costs a slope that is fitted to it."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["slope_variance_of_steps", "step_of"]

Floats: TypeAlias = NDArray[np.float64]

HARMONICS, TRIED = 20, 201
LEAST_SHARE = 1e-3
"""Readings closer together than this share of a step are the same one, in floating-point numbers."""


def step_of(readings: Floats, sd: float) -> float:
    """The step in which readings, (n), come: their smallest difference, but none larger than their SD tells of.

    Readings without steps come arbitrarily close to each other, so that their step is nearly nothing.

    Examples
    --------
    >>> round(step_of(0.37 * np.array([9.0, 8.0, 8.0, 6.0, 5.0]), 0.37 / 12**0.5), 3)
    0.37
    """
    most = sd * 12**0.5
    apart = np.diff(np.sort(readings))
    apart = apart[apart > LEAST_SHARE * most]
    return min(float(apart.min(initial=np.inf)), most)


def slope_variance_of_steps(readings: Floats, step: float) -> float:
    """Variance that steps give the slope over readings, (n), beyond that of independent errors: times (range / step)^2.

    Notes
    -----
    Rounding errs by a saw-tooth of the way. Of a way that goes on by s steps a sample its harmonic k has the variance
    1 / (2 pi^2 k^2) and is sampled at k s periods a sample, less whole ones, which makes p periods over n samples. A
    straight line fitted to it has up to the slope G(p) over the range, G = 6 (sin(w) / w^2 - cos(w) / w) and w = pi p.
    With all phases as likely the variance is the sum of G(p)^2 / (2 pi^2 k^2). At less than a period it is up to 0.36,
    an SD of twice the rounding's own, however many samples there are; for fast saw-teeth it is 1 / n at most, as of
    independent errors, which a fit counts already. From n readings s is known to a triangle of 1 / n to either side.

    Examples
    --------
    Jaws that go on by just one step a sample, beside some that go on by a third of one:

    >>> round(slope_variance_of_steps(np.arange(60.0, 0, -1), 1.0), 2)
    0.22
    >>> round(slope_variance_of_steps(np.round(np.arange(60, 0, -1 / 3)), 1.0), 2)
    0.01
    """
    count = readings.size
    if count < 3 or step <= 0:
        return 0.0
    pace = abs(float(readings[-1] - readings[0])) / step / (count - 1)
    off = np.linspace(-1, 1, TRIED + 2)[1:-1]
    likely = (1 - np.abs(off)) / np.sum(1 - np.abs(off))
    orders = np.arange(1, HARMONICS + 1)[:, None]
    frequency = orders * (pace + off / (count - 1))
    angle = np.pi * count * np.abs(frequency - np.round(frequency))
    angle = np.maximum(angle, 1e-3)
    gain = 6 * (np.sin(angle) / angle**2 - np.cos(angle) / angle)
    variance = float(np.sum(gain**2 @ likely / (2 * np.pi**2 * orders[:, 0] ** 2)))
    return max(variance - 1 / count, 0.0)
