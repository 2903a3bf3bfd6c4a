"""How good beliefs are where the truth is known: proper scores, calibration and coverage."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError
from palpate.inference.marginals import ContinuousMarginal

__all__ = ["FLOOR", "brier", "class_wise_ece", "covered", "cross_entropy_bits", "crps"]

Array = NDArray[np.float64]

FLOOR = 1e-6
"""Smallest probability of the truth that is counted: no belief scores worse than 19.93 bits."""


def cross_entropy_bits(probabilities: Array, truth: int, floor: float = FLOOR) -> float:
    """Cross-entropy of the truth, -log2 p(true state) [bits], with the probability floored.

    Source: the logarithmic score of Good (1952).

    Parameters
    ----------
    probabilities
        Of the states (S,); they sum to one.
    truth
        Index of the true state.

    Examples
    --------
    >>> cross_entropy_bits(np.array([0.25, 0.75]), 0)
    2.0
    >>> round(cross_entropy_bits(np.array([0.0, 1.0]), 0), 2)
    19.93
    """
    return float(-np.log2(max(float(probabilities[truth]), floor)))


def brier(probabilities: Array, truth: int) -> float:
    """Squared distance of the probabilities (S,) from certainty about the true state, 0 to 2.

    Source: Brier (1950).

    Examples
    --------
    >>> brier(np.array([0.5, 0.5]), 0)
    0.5
    """
    return float(np.sum(probabilities**2) - 2 * probabilities[truth] + 1)


def crps(marginal: ContinuousMarginal, truth: float) -> float:
    """Continuous ranked probability score of a belief about a number [its unit].

    The integral of (F(x) - [x >= truth])^2 over x, as E|X - truth| - E|X - X'| / 2 with the
    belief's masses at the nodes of its mesh.

    Source: Gneiting and Raftery (2007), equation 21.

    Returns
    -------
    float
        Zero or above, zero for certainty of the truth; not a number where nothing is said.
    """
    nodes, masses = marginal.nodes, marginal.masses
    if not nodes.size:
        return float("nan")
    # E|X - X'| / 2 = sum over sorted x of x p (2 P(X < x) + p - 1)
    below = np.cumsum(masses) - masses
    spread = float(np.sum(nodes * masses * (2 * below + masses - 1)))
    return float(masses @ np.abs(nodes - truth)) - spread


def covered(rank: Array, level: float) -> Array:
    """Whether the central interval of a level holds the truth (N,), 1 or 0; not a number where the rank is none.

    Parameters
    ----------
    rank
        P(X <= truth) under each belief (N,).
    level
        Probability of the interval, such as 0.5: it runs from the 25 % to the 75 % quantile.

    Examples
    --------
    >>> covered(np.array([0.3, 0.8]), 0.5).tolist()
    [1.0, 0.0]
    """
    inside = np.abs(rank - 0.5) <= level / 2
    return np.where(np.isnan(rank), np.nan, inside.astype(float))


def class_wise_ece(
    probabilities: Array, truth: NDArray[np.intp], weights: Array | None = None, bins: int = 15
) -> float:
    """Class-wise expected calibration error: how far probabilities are from frequencies, 0 to 1.

    For each state, beliefs are put into bins of equal width by its probability; the distances
    between mean probability and frequency, weighted by the beliefs in the bin, are summed, and the
    mean over the states is taken.

    Source: Kull et al. (2019), Beyond temperature scaling, section 2.

    Parameters
    ----------
    probabilities
        A belief per row (N, S); rows sum to one.
    truth
        Index of the true state of each (N,).
    weights
        Of the beliefs (N,), equal unless given.

    Raises
    ------
    EvidenceError
        There is no belief.

    Examples
    --------
    >>> class_wise_ece(np.array([[0.75, 0.25]] * 4), np.array([0, 0, 0, 1]))
    0.0
    """
    if not len(probabilities):
        raise EvidenceError("class-wise calibration: no belief was found, expected at least one")
    share = np.full(len(truth), 1 / len(truth)) if weights is None else weights / weights.sum()
    return float(np.mean([_gap(p, truth == state, share, bins) for state, p in enumerate(probabilities.T)]))


def _gap(p: Array, hit: NDArray[np.bool_], share: Array, bins: int) -> float:
    """Sum over bins of |mean probability - frequency|, weighted by the share of each bin."""
    bin_of = np.minimum((p * bins).astype(np.intp), bins - 1)
    return float(np.abs(np.bincount(bin_of, share * (p - hit), bins)).sum())
