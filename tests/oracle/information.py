"""Mutual information and divergence of tables of masses, in bits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def mutual_information(blocks: Sequence[Array]) -> float:
    """I(Z; Y) of joint masses, given as blocks of rows z with all columns y."""
    y = np.sum([block.sum(axis=0) for block in blocks], axis=0)
    total, bits = float(y.sum()), 0.0
    for block in blocks:
        z = block.sum(axis=1)
        # sum of p log(p / (z y / total)), each term with its own p so that nothing overflows
        bits += _p_log_p(block) - _p_log_p(z)
    return (bits - _p_log_p(y)) / total + float(np.log2(total))


def _p_log_p(p: Array) -> float:
    on = p[p > 0]
    return float(on @ np.log2(on))


def divergence(after: Array, before: Array) -> float:
    """KL(after || before) of masses on the same cells."""
    p, q = after / after.sum(), before / before.sum()
    on = p > 0
    return float((p[on] * np.log2(p[on] / q[on])).sum())


def entropy(p: Array) -> float:
    """Entropy of probabilities."""
    on = p > 0
    return float(-(p[on] * np.log2(p[on])).sum())
