"""Location and spread of values of which a few may be wrong.

1. Of the outer fifth of the values on either side only the side counts, not how far out they are: they enter the
   likelihood as a censored sample (Harter and Moore 1966, Biometrika 53), which holds for every family and truncation.
2. A value of that outer fifth is left out where, by this estimate, not even one in twenty samples of the size has one
   so far out; as the estimate is of few values, tails are those of Student's t and not of a normal.
3. The estimate is the most likely one for the values that remain, as in Rousseeuw and Leroy (1987), Robust Regression
   and Outlier Detection, chapter 4: where nothing is left out it is plain maximum likelihood, and as efficient.
4. The spread is that of what a new object will have: as the location is of n values only, and was fitted to them, its
   square is (n + 1) / (n - 1) of the most likely one, which is the scale of the predictive distribution of a normal
   (Gelman et al. 2013, Bayesian Data Analysis, 3.2). Of a single value, n - 1 counts as a half.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import special

from palpate.fitting.forms import Form
from palpate.fitting.likelihood import Prior, Sample, most_likely

__all__ = ["FEWEST", "Estimate", "estimate", "resolution", "widened"]

Array = NDArray[np.float64]

FEWEST = 5
"""Of fewer values none is left out: nobody can say which is the odd one."""
OUTER = 5
"""One in so many values is outer, on either side."""
SURE = 0.05
"""Probability with which a sample without errors has one value that is left out."""
LEAST = 1e-300
NORMAL = 1.4826
"""SD of a normal over the median distance from its median."""


@dataclass(frozen=True)
class Estimate:
    """Location and spread, and which of the values were used (n,)."""

    location: float
    spread: float
    used: NDArray[np.bool_]


def estimate(form: Form, values: Array, floor: float, prior: Prior | None = None) -> Estimate:
    """Estimate location and spread.

    Parameters
    ----------
    values
        At least one; without a prior two that differ.
    floor
        Least spread, as values are rounded.
    prior
        What all values say; None where they are all there is.
    """
    order = np.argsort(values, kind="stable")
    ranked = values[order]
    used = np.ones(len(ranked), dtype=bool)
    outer = len(ranked) // OUTER if len(ranked) >= FEWEST else 0
    start = _start(form, ranked, floor, prior)
    if outer:
        inner = Sample(ranked[outer : len(ranked) - outer], outer, outer)
        start = most_likely(form, inner, start, floor, prior)
        used = _plausible(form, ranked, outer, start)
    location, spread = most_likely(form, Sample(ranked[used]), start, floor, prior)
    back = np.empty_like(used)
    back[order] = used
    return Estimate(location, spread * widened(int(used.sum())), back)


def widened(count: int) -> float:
    """How much larger the spread of a new value is than the most likely one of so many values.

    Examples
    --------
    >>> widened(3) ** 2, round(widened(101) ** 2, 2)
    (2.0000000000000004, 1.02)
    """
    return float(np.sqrt((count + 1) / max(count - 1, 0.5)))


def _start(form: Form, ranked: Array, floor: float, prior: Prior | None) -> tuple[float, float]:
    x = form.values(ranked)
    middle = float(np.median(x))
    spread = NORMAL * float(np.median(np.abs(x - middle))) or float(np.std(x))
    return middle, max(floor, spread if len(x) > 1 or prior is None else prior.spread)


def _plausible(form: Form, ranked: Array, outer: int, start: tuple[float, float]) -> NDArray[np.bool_]:
    family = form.family(*start)
    below = np.asarray(family.cdf(ranked))
    # how many SDs out a normal value of this probability is
    out = -special.ndtri(np.maximum(np.minimum(below, 1 - below), LEAST))
    odd = len(ranked) * 2 * special.stdtr(len(ranked) - 2 * outer - 1, -out) < SURE
    odd[outer : len(ranked) - outer] = False
    return np.asarray(~odd)


def resolution(x: Array) -> float:
    """Least spread that values can tell: the SD of rounding to the least difference of two; 0 where all are the same.

    Examples
    --------
    >>> round(resolution(np.array([1.0, 2.0, 2.0, 4.0])), 4)
    0.2887
    """
    steps = np.diff(np.unique(x))
    return float(steps.min() / np.sqrt(12)) if steps.size else 0.0
