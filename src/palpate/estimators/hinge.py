"""A line that begins at an unknown point: y = idle + slope x max(0, contact - x), with errors in both x and y."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.correlated import covariance_of_fit
from palpate.estimators.steps import slope_variance_of_steps, step_of

__all__ = ["Hinge", "fit_hinge", "scatter"]

CANDIDATES = 200
FLOOR = 1e-9
LEAST_SHARE = 0.01
"""A force has at least this share of the errors that the gap's make in it."""


@dataclass(frozen=True)
class Hinge:
    """A fitted hinge; x falls as contact is made.

    Attributes
    ----------
    contact
        Where the line begins.
    slope
        How fast y grows as x falls below it.
    idle_force
        y without contact.
    covariance
        Of contact, slope and idle force, (3, 3).
    noise_sd
        SD of the errors in y, from sample to sample.
    """

    contact: float
    slope: float
    idle_force: float
    covariance: NDArray[np.float64]
    noise_sd: float

    @property
    def slope_sd(self) -> float:
        """SD of the slope."""
        return float(np.sqrt(self.covariance[1, 1]))

    @property
    def relative_sd(self) -> float:
        """SD of the slope over the slope."""
        return self.slope_sd / abs(self.slope)

    @property
    def relative_sd_of_product(self) -> float:
        """SD over value of slope x contact."""
        gradient = np.array([1 / self.contact, 1 / self.slope, 0.0])
        return float(np.sqrt(gradient @ self.covariance @ gradient))

    def at(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """y at x, (n)."""
        return self.idle_force + self.slope * np.maximum(0.0, self.contact - x)

    def explained(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
        """Share of the variance of y in contact that the line explains; 0 where there is too little of either."""
        inside = x < self.contact
        if np.count_nonzero(inside) < 3 or np.ptp(y[inside]) == 0:
            return 0.0
        left = float(np.mean((y - self.at(x))[inside] ** 2))
        return 1 - left / float(np.var(y[inside]))


def fit_hinge(x: NDArray[np.float64], y: NDArray[np.float64], *, gap_sd: float, force_sd: float | None) -> Hinge:
    """Fit a hinge by weighted least squares; the weights are those of errors in both variables.

    Parameters
    ----------
    x, y
        Samples, (n).
    gap_sd
        SD of the errors in x.
    force_sd
        SD of the errors in y; estimated where it is None.

    Notes
    -----
    For given k, residuals in contact have the variance force_sd^2 + (k gap_sd)^2: with it their squares are least at
    the structural line (Deming, 1943), where ordinary least squares are biased towards a flat one. Within the
    gap's error of the contact, it is as likely as not that there is any.
    """
    from scipy.optimize import least_squares

    start = _coarse(x, y)
    sd = force_sd if force_sd is not None else _scatter(x, y, start)
    scale = np.array([max(np.ptp(x), FLOOR), max(abs(start[1]), FLOOR), max(np.ptp(y), FLOOR)])
    # a force without any noise must not make of readings one step off impossible ones
    least = max(FLOOR * scale[2], LEAST_SHARE * abs(start[1]) * gap_sd)

    def residuals(scaled: NDArray[np.float64]) -> NDArray[np.float64]:
        contact, slope, idle = scaled * scale
        spread = np.sqrt(max(sd, least) ** 2 + _of_gap(x, contact, slope, gap_sd) ** 2)
        found: NDArray[np.float64] = (y - idle - slope * np.maximum(0.0, contact - x)) / spread
        return found

    found = least_squares(residuals, start / scale, x_scale="jac", max_nfev=200)
    contact, slope, idle = found.x * scale
    covariance = _covariance(x, y, found.x * scale, gap_sd=gap_sd, force_sd=max(sd, least))
    return Hinge(float(contact), float(slope), float(idle), covariance, sd)


def _of_gap(x: NDArray[np.float64], contact: float, slope: float, gap_sd: float) -> NDArray[np.float64]:
    """SD in y of the errors in x, (n): none without contact."""
    share = np.clip((contact - x) / max(12**0.5 * gap_sd, FLOOR) + 0.5, 0.0, 1.0)
    found: NDArray[np.float64] = abs(slope) * gap_sd * np.sqrt(share)
    return found


def _covariance(
    x: NDArray[np.float64], y: NDArray[np.float64], fitted: NDArray[np.float64], *, gap_sd: float, force_sd: float
) -> NDArray[np.float64]:
    """Covariance of contact, slope and idle force: errors that resemble their neighbours, and steps of x, included."""
    contact, slope, idle = fitted
    way = np.maximum(0.0, contact - x)
    jacobian = np.column_stack([slope * (way > 0), way, np.ones(x.size)])
    of_gap = _of_gap(x, contact, slope, gap_sd)
    variance = force_sd**2 + of_gap**2
    covariance = covariance_of_fit(jacobian, y - idle - slope * way, 1 / variance, of_gap)
    stated = np.linalg.pinv(jacobian.T @ (jacobian / variance[:, None]))
    if stated[1, 1] > covariance[1, 1]:
        # residuals that happen to be small do not take back what was stated
        covariance = np.asarray(stated, dtype=np.float64)
    inside = x[way > 0]
    if inside.size:
        step = step_of(x, gap_sd)
        closing = inside[: int(np.argmin(inside)) + 1]
        covariance[1, 1] += slope_variance_of_steps(closing, step) * (slope * step / way.max()) ** 2
        covariance[0, 0] += step**2 / 12
    return covariance


def _coarse(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Contact, slope and idle force with the least squares over a row of contact points."""
    best, least = np.array([x.max(), 0.0, y.mean()]), np.inf
    for contact in np.linspace(x.min(), x.max() + 0.25 * np.ptp(x), CANDIDATES + 1)[1:]:
        inside = np.maximum(0.0, contact - x)
        centred = inside - inside.mean()
        power = float(centred @ centred)
        if power <= 0:
            continue
        slope = float(centred @ y) / power
        idle = float(y.mean() - slope * inside.mean())
        squares = float(np.sum((y - idle - slope * inside) ** 2))
        if squares < least:
            best, least = np.array([contact, slope, idle]), squares
    return best


def _scatter(x: NDArray[np.float64], y: NDArray[np.float64], start: NDArray[np.float64]) -> float:
    """SD of y without contact, or of its errors all along where there is too little of that."""
    outside = y[x > start[0]]
    if outside.size >= 8 and outside.std() > 0:
        return float(outside.std(ddof=1))
    return scatter(y) + FLOOR * float(np.ptp(y))


def scatter(y: NDArray[np.float64]) -> float:
    """SD of independent errors on a smooth curve, (n)."""
    rough = np.diff(y, 2)
    # the second difference of independent errors has 6 times their variance; the median leaves out the bend
    return float(np.median(np.abs(rough)) / 0.6745 / np.sqrt(6))
