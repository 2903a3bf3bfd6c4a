"""What all signals must be before anything is estimated from them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.errors import PalpateError

__all__ = ["EstimatorError", "SignalError", "check_clipping", "correlation_factor", "samples", "together"]

CLIPPED, LEAST_CLIPPED, RUN = 0.02, 10, 3
"""A signal is cut off where this share of its samples, and so many, are at one end in runs of so many."""

MOST_ALIKE = 0.98

LARGEST = 1e50
"""No sensor reads so much, and squares of what is larger are none that can be added up."""


class EstimatorError(PalpateError, ValueError):
    """A call that cannot be right whatever was measured: arrays that do not belong together, an area below zero."""


class SignalError(PalpateError, ValueError):
    """A signal from which nothing can be estimated; estimators turn it into a failed outcome."""


def samples(name: str, values: ArrayLike, *, at_least: int = 1, may_clip: bool = True) -> NDArray[np.float64]:
    """Samples as an array of numbers, (n,).

    Parameters
    ----------
    name
        What they are, for the message.
    at_least
        How many are needed.
    may_clip
        Whether many samples at one end are in order, as in a gap that rests when it is closed.

    Raises
    ------
    EstimatorError
        If they are no row of numbers.
    SignalError
        If there are too few, some are not finite or larger than any that can be, or they are cut off.

    Examples
    --------
    >>> samples("force_n", [0, 1, 2])
    array([0., 1., 2.])
    >>> samples("force_n", [0, float("nan")])
    Traceback (most recent call last):
    palpate.estimators.signals.SignalError: force_n: 1 of 2 samples are not finite
    """
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise EstimatorError(f"{name}: found no numbers, expected samples of shape (n,)") from None
    if found.ndim != 1:
        raise EstimatorError(f"{name}: found shape {found.shape}, expected (n,)")
    if found.size < at_least:
        raise SignalError(f"{name}: {found.size} samples, at least {at_least} are needed")
    bad = int(np.count_nonzero(~np.isfinite(found)))
    if bad:
        raise SignalError(f"{name}: {bad} of {found.size} samples are not finite")
    if found.size and (largest := float(np.abs(found).max())) > LARGEST:
        raise SignalError(f"{name}: a sample is {largest:g} in size, expected {LARGEST:g} at most")
    if not may_clip:
        check_clipping(name, found)
    return found


def together(**signals: NDArray[np.float64]) -> None:
    """Refuse signals of different lengths: nobody knows which samples belong together.

    Raises
    ------
    EstimatorError
        Naming them.
    """
    lengths = {name: len(values) for name, values in signals.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise EstimatorError(f"signals of different lengths: {told} samples, expected the same number of each")


def check_clipping(name: str, values: NDArray[np.float64]) -> None:
    """Refuse samples, (n,), that are cut off at their largest or least value.

    They are where many rest there, several in a row: noise, and a sensor of few steps, come back at once. Two values
    alone say nothing of what lies beyond them.

    Raises
    ------
    SignalError
        If they are cut off.

    Examples
    --------
    >>> check_clipping("sound", np.clip(np.sin(np.arange(400) / 20), -1.0, 0.9))
    Traceback (most recent call last):
    palpate.estimators.signals.SignalError: sound: 14% of the samples are at the largest value 0.9: cut off
    """
    low, high = float(values.min()), float(values.max())
    for end, words in ((high, "largest"), (low, "least")):
        # equal to the last digit: what settles comes near its end and is not cut off there
        count = _in_runs(values == end)
        if count >= max(LEAST_CLIPPED, CLIPPED * values.size) and np.any((values != low) & (values != high)):
            raise SignalError(
                f"{name}: {count / values.size:.0%} of the samples are at the {words} value {end:g}: cut off"
            )


def _in_runs(marked: NDArray[np.bool_]) -> int:
    """How many of the marks stand in runs of `RUN` or more."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    lengths = edges[1::2] - edges[::2]
    return int(lengths[lengths >= RUN].sum())


def correlation_factor(residuals: NDArray[np.float64], *, fitted: int = 1) -> float:
    """By how much the variance of a mean grows where samples resemble their neighbours: that of lag one tells.

    Of few samples both the correlation and the scatter about a fit come out too small; both are put right. Sources: the
    bias of the correlation, Marriott and Pope (1954), Biometrika 41; the variance of a mean of correlated samples,
    Bayley and Hammersley (1946), Supplement to JRSS 8.

    Parameters
    ----------
    residuals
        Samples less what was fitted to them, (n,).
    fitted
        How many numbers were fitted: 1 for a level.

    Examples
    --------
    >>> correlation_factor(np.array([1.0, -1.0, 1.0, -1.0]))
    1.0
    """
    count, power = residuals.size, float(residuals @ residuals)
    lag = float(residuals[1:] @ residuals[:-1]) / power if power > 0 else 0.0
    lag = min(max(lag + (fitted + 2 * (1 + fitted) * lag) / count, 0.0), MOST_ALIKE)
    factor = (1 + lag) / (1 - lag) - 2 * lag * (1 - lag**count) / (count * (1 - lag) ** 2)
    return factor * max(count - fitted, 1) / max(count - fitted * factor, 1.0)
