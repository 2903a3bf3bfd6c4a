"""Entropy, mutual information and divergence of probability tables, in bits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["entropy_bits", "kl_bits", "mutual_information_bits", "p_log_p", "sum_p_log_p"]

Array = NDArray[np.float64]
TINY = np.finfo(float).tiny


def p_log_p(p: Array) -> Array:
    """Return p ln p of each entry, with 0 ln 0 = 0 [nats]."""
    return np.asarray(p * np.log(np.maximum(p, TINY)))


def sum_p_log_p(p: Array) -> float:
    """Sum of p ln p over all entries, with 0 ln 0 = 0 [nats]."""
    # The smallest normal number in place of zero adds nothing and needs no mask.
    return float(np.vdot(p, np.log(np.maximum(p, TINY))))


def entropy_bits(p: Array) -> float:
    """Entropy of a table that sums to one.

    Examples
    --------
    >>> entropy_bits(np.array([0.5, 0.25, 0.25]))
    1.5
    """
    return float(abs(sum_p_log_p(p)) / np.log(2))


def mutual_information_bits(joint: Array) -> float:
    """Mutual information of the rows and the columns of a table that sums to one; never negative.

    Examples
    --------
    >>> round(mutual_information_bits(np.array([[0.5, 0.0], [0.0, 0.5]])), 12)
    1.0
    """
    nats = sum_p_log_p(joint) - sum_p_log_p(joint.sum(axis=0)) - sum_p_log_p(joint.sum(axis=1))
    return max(0.0, nats / float(np.log(2)))


def kl_bits(after: Array, before: Array) -> float:
    """Kullback-Leibler divergence KL(after || before) of two tables that sum to one.

    Infinite where `after` has mass and `before` has none.
    """
    held = after > 0
    with np.errstate(divide="ignore"):
        return max(0.0, float(np.sum(after[held] * np.log2(after[held] / before[held]))))
