"""How sure a fit is whose errors resemble their neighbours, as those of a force that wanders do.

The errors are taken as a known white part, and noise of which a share wanders as an AR(1). How much, which share and
for how long is not known, and in few samples hardly to be seen: all that is possible is weighed by the restricted
likelihood of what the fit left (Patterson and Thompson, 1971, Biometrika 58), and the covariances are averaged by these
weights.
"""

from __future__ import annotations

from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["covariance_of_fit"]

Floats: TypeAlias = NDArray[np.float64]

FACTORS = 2.0 ** np.arange(-2.0, 2.6, 0.5)
"""SD of the noise over that of the residuals: what wanders slowly is larger than what it leaves of itself."""
SHARES, LIKENESSES = (0.3, 0.6, 1.0), (0.5, 0.7, 0.8, 0.87, 0.92, 0.95, 0.97, 0.98, 0.99)
"""Share of the noise's variance that wanders, and how alike it is from sample to sample."""
WHITE = 0.5
"""Probability beforehand that nothing wanders."""
LEAST, NOTHING = 1e-12, 1e-9


def covariance_of_fit(jacobian: Floats, residuals: Floats, weights: Floats, white_sd: Floats) -> Floats:
    """Covariance of what weighted least squares found, (p, p).

    Parameters
    ----------
    jacobian
        Change of the fitted curve by what was fitted, (n, p).
    residuals
        Samples less the curve, (n).
    weights
        By which their squares were multiplied, (n).
    white_sd
        SD of the part of the errors that is known to be independent, (n); noise of any size comes on top.

    Examples
    --------
    A level of 400 independent samples is known twenty times better than one sample:

    >>> noise = np.random.default_rng(0).normal(0, 1, 400)
    >>> found = covariance_of_fit(np.ones((400, 1)), noise - noise.mean(), np.ones(400), np.zeros(400))
    >>> 0.04 < float(found[0, 0]) ** 0.5 < 0.07
    True
    """
    size = float(np.sqrt(np.mean(residuals**2)))
    # by a pseudoinverse of rows and not of their products: columns may be of very different units
    roots = np.sqrt(weights)[:, None]
    estimator = np.asarray(np.linalg.pinv(roots * jacobian).T * roots, dtype=np.float64)
    unit = float(np.hypot(size, white_sd.max(initial=0.0)))
    if size <= NOTHING * unit:
        return (estimator * white_sd[:, None] ** 2).T @ estimator
    # in units of the errors, whose squares may be no number otherwise
    estimator, residuals, white_sd, size = estimator * unit, residuals / unit, white_sd / unit, size / unit
    grid = [(size * factor, 0.0, 0.0) for factor in FACTORS]
    grid += [(size * factor, *of) for factor, of in product(FACTORS, product(SHARES, LIKENESSES))]
    sd, share, alike = np.array(grid).T
    prior = np.where(share == 0, WHITE / FACTORS.size, (1 - WHITE) / (len(grid) - FACTORS.size))
    log = np.log(prior) + _likelihood(jacobian, residuals, white_sd, sd**2, share, alike)
    belief = np.exp(log - log.max())
    belief /= belief.sum()
    variances = white_sd**2 + float(belief @ (sd**2 * (1 - share)))
    covariance: Floats = (estimator * variances[:, None]).T @ estimator
    for likeness in LIKENESSES:
        here = alike == likeness
        power = float(belief[here] @ (sd**2 * share)[here])
        covariance += power * estimator.T @ _neighbours(estimator, likeness)
    return covariance


def _neighbours(columns: Floats, alike: float) -> Floats:
    """Columns times the correlations of an AR(1), (n, p)."""
    from scipy.signal import lfilter

    before = lfilter([1.0], [1.0, -alike], columns, axis=0)
    after = lfilter([1.0], [1.0, -alike], columns[::-1], axis=0)[::-1]
    found: Floats = before + after - columns
    return found


def _likelihood(
    jacobian: Floats, residuals: Floats, white_sd: Floats, variance: Floats, share: Floats, alike: Floats
) -> Floats:
    """Logarithm of the restricted likelihood of each kind of noise, (g), by a Kalman filter of what wanders."""
    count = jacobian.shape[1]
    # unit columns: the likelihood must not depend on the units of what was fitted
    norms = np.linalg.norm(jacobian, axis=0)
    rows = np.column_stack([jacobian / np.where(norms > 0, norms, 1.0), residuals])
    still, wanders = variance * (1 - share), variance * share
    fresh = wanders * (1 - alike**2)
    mean, spread = np.zeros((variance.size, count + 1)), wanders.copy()
    logs, products = np.zeros(variance.size), np.zeros((variance.size, count + 1, count + 1))
    for row, white in zip(rows, white_sd**2, strict=True):
        total = spread + still + white
        new = row - mean
        logs += np.log(total)
        products += new[:, :, None] * (new / total[:, None])[:, None, :]
        gain = spread / total
        mean = alike[:, None] * (mean + gain[:, None] * new)
        spread = alike**2 * spread * (1 - gain) + fresh
    # what the columns could still explain is not left over
    information = products[:, :count, :count]
    information = information + LEAST * np.eye(count) * np.trace(information, axis1=1, axis2=2)[:, None, None]
    cross = products[:, :count, count]
    explained = np.einsum("gp,gp->g", cross, np.linalg.solve(information, cross[:, :, None])[:, :, 0])
    _, volume = np.linalg.slogdet(information)
    found: Floats = -0.5 * (logs + volume + products[:, count, count] - explained)
    return found
