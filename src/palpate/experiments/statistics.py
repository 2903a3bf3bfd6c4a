"""Statistics of paired comparisons in which objects, and not runs, are the unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError

__all__ = ["Contrast", "adjusted", "bootstrap_interval", "contrast", "holm", "object_means", "sign_flip_p"]

Array = NDArray[np.float64]

EXACT_UP_TO = 16
"""Objects up to which all sign flips are counted; beyond, they are drawn."""
FLIPS = 20_000
RESAMPLES = 10_000
CHUNK = 500
"""Draws worked out at a time, for the memory they take."""


@dataclass(frozen=True)
class Contrast:
    """The difference of two arms over objects.

    Parameters
    ----------
    mean
        Mean over objects of the paired differences; below zero where the first arm is lower.
    low, high
        95 % interval of it.
    p
        Two-sided p-value of no difference.
    adjusted_p
        The p-value after Holm over the family of contrasts; None where there is no family.
    """

    name: str
    mean: float
    low: float
    high: float
    p: float
    objects: int
    adjusted_p: float | None = None


def object_means(objects: Sequence[str], values: Array, weights: Array | None = None) -> dict[str, float]:
    """Weighted mean of the values of each object, in order of first appearance; missing values are left out.

    Examples
    --------
    >>> object_means(["mug", "mug", "box"], np.array([1.0, 3.0, 5.0]))
    {'mug': 2.0, 'box': 5.0}
    """
    names, place = np.unique(np.asarray(objects), return_inverse=True)
    known = ~np.isnan(values)
    share = np.where(known, 1.0 if weights is None else weights, 0.0)
    total = np.bincount(place, share, len(names))
    summed = np.bincount(place, share * np.where(known, values, 0.0), len(names))
    found = {str(n): s / t for n, s, t in zip(names, summed.tolist(), total.tolist(), strict=True) if t > 0}
    return {name: found[name] for name in dict.fromkeys(objects) if name in found}


def sign_flip_p(differences: Array, seed: int = 0) -> float:
    """Two-sided p-value of the hypothesis that the sign of each object's difference is chance.

    All 2^n flips are counted for up to 16 objects; else 20 000 are drawn, the one observed among them.

    Source: Fisher's randomisation test, as in Good (2005), Permutation, Parametric and Bootstrap
    Tests of Hypotheses, chapter 3; counting the observed flip: Phipson and Smyth (2010).

    Parameters
    ----------
    differences
        One per object (n,).

    Examples
    --------
    >>> sign_flip_p(np.array([1.0, 2.0, 3.0]))
    0.25
    """
    n = _counted(differences)
    least = abs(differences.sum()) * (1 - 1e-12)
    if n <= EXACT_UP_TO:
        signs = 1.0 - 2.0 * ((np.arange(2**n)[:, None] >> np.arange(n)) & 1)
        return float(np.mean(np.abs(signs @ differences) >= least))
    rng, extreme = np.random.default_rng(seed), 0
    for start in range(0, FLIPS, CHUNK):
        signs = 1.0 - 2.0 * rng.integers(0, 2, size=(min(CHUNK, FLIPS - start), n))
        extreme += int(np.sum(np.abs(signs @ differences) >= least))
    return (extreme + 1) / (FLIPS + 1)


def bootstrap_interval(values: Array, level: float = 0.95, seed: int = 0) -> tuple[float, float]:
    """Percentile interval of the mean, objects drawn again with all that was measured on them.

    Source: Efron and Tibshirani (1993), chapter 13; clusters as in Davison and Hinkley (1997), 3.8.

    Parameters
    ----------
    values
        The mean of each object (n,).
    """
    n = _counted(values)
    rng = np.random.default_rng(seed)
    means = [values[rng.integers(0, n, size=(CHUNK, n))].mean(axis=1) for _ in range(RESAMPLES // CHUNK)]
    low, high = np.quantile(np.concatenate(means), [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)


def holm(p_values: Sequence[float]) -> list[float]:
    """p-values adjusted for their number by the step-down method of Holm (1979), in the order given.

    Examples
    --------
    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    """
    adjusted, largest = [0.0] * len(p_values), 0.0
    for rank, place in enumerate(sorted(range(len(p_values)), key=lambda i: p_values[i])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[place]))
        adjusted[place] = largest
    return adjusted


def contrast(name: str, first: dict[str, float], second: dict[str, float], seed: int = 0) -> Contrast:
    """First less second, over the objects that both have.

    Raises
    ------
    EvidenceError
        They have no object in common.

    Examples
    --------
    >>> found = contrast("a less b", {"mug": 1.0, "box": 2.0}, {"mug": 2.0, "box": 4.0})
    >>> found.mean, found.p, found.objects
    (-1.5, 0.5, 2)
    """
    shared = [key for key in first if key in second]
    differences = np.array([first[key] - second[key] for key in shared])
    p = sign_flip_p(differences, seed)
    low, high = bootstrap_interval(differences, seed=seed)
    return Contrast(name, float(differences.mean()), low, high, p, len(shared))


def adjusted(family: Sequence[Contrast]) -> list[Contrast]:
    """The contrasts of a family with p-values adjusted for their number."""
    p_values = holm([one.p for one in family])
    return [replace(one, adjusted_p=p) for one, p in zip(family, p_values, strict=True)]


def _counted(values: Array) -> int:
    """How many objects there are; EvidenceError if there are none."""
    if not len(values):
        raise EvidenceError("a comparison of paired objects: no object was found, expected at least one")
    return len(values)
