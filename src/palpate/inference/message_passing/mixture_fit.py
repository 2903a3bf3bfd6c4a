"""Mixtures of normals: reference components on a grid, and weights fitted by EM."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError, extra
from palpate.inference.message_passing.grid import Grid
from palpate.inference.message_passing.settings import Settings

__all__ = ["Mixture", "fit_weights", "scikit_learn_start", "weights_of"]

Array = NDArray[np.float64]

REACH = 5.0
"""SDs that a grid reaches beyond the lowest and the highest mean."""
STEPS_PER_SD = 10
"""Steps of a grid within the smallest SD."""
NOTHING = 10 * np.finfo(float).eps
"""Samples that even an empty component has, so that nothing is divided by zero."""
LEAST_VARIANCE = 1e-6
"""Added to every variance, so that none vanishes."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """Reference components of a continuous node.

    Parameters
    ----------
    means, sds
        Of each component (C,) [unit]; they are not truncated.
    grid
        The grid of the node's densities.
    """

    means: Array
    sds: Array
    grid: Grid

    @classmethod
    def on_own_grid(cls, means: Array, sds: Array) -> Self:
        """The components on the grid from the lowest mean - 5 of its SD to the highest mean + 5 of its SD."""
        low, high = int(means.argmin()), int(means.argmax())
        ends = (float(means[low] - REACH * sds[low]), float(means[high] + REACH * sds[high]))
        return cls(means, sds, Grid.regular(*ends, float(sds.min()) / STEPS_PER_SD))

    @cached_property
    def components(self) -> Array:
        """Densities of the components at the nodes (K, C) [1/unit]."""
        z = (self.grid.nodes[:, None] - self.means) / self.sds
        return np.asarray(np.exp(-0.5 * z * z) / (self.sds * np.sqrt(2 * np.pi)))

    def density(self, weights: Array) -> Array:
        """The mixture with these weights at the nodes (K,), not scaled to the part of it on the grid."""
        return np.asarray(self.components @ weights)


def scikit_learn_start() -> Any:
    """scikit-learn's `KMeans`, imported when it is first needed.

    Raises
    ------
    PalpateError
        scikit-learn is not installed.
    """
    try:
        from sklearn.cluster import KMeans
    except ImportError as error:
        raise PalpateError(
            f"the message-passing engine needs scikit-learn, which is not installed: {extra('reproduce')}"
        ) from error
    return KMeans


def fit_weights(
    samples: Array, means: Array, iterations: int, tolerance: float, rng: np.random.Generator
) -> tuple[Array, bool]:
    """Weights of a mixture of normals fitted to samples by EM, and whether the fit converged.

    Means and SDs move in the fit too and are forgotten: a weight belongs to the reference mean of
    the same index, wherever its component has moved to.

    Source: Dempster, Laird and Rubin 1977. Start, steps and rule to stop are those of scikit-learn's
    ``GaussianMixture(means_init=...)``, to rounding; samples of a grid repeat, and here each of
    their values is worked on once.

    Parameters
    ----------
    samples
        (n,), at least as many as there are means.
    means
        Where the means start (C,).
    tolerance
        Gain in mean log likelihood below which the fit has converged [nats].

    Returns
    -------
    weights, converged
        The weights (C,) sum to one.
    """
    values, counts = np.unique(samples, return_counts=True)
    weights, variances = _start(samples, len(means), rng)
    bound = -np.inf
    for _ in range(iterations):
        before = bound
        shares, bound = _expectation(values, counts, weights, means, variances)
        sizes = shares.sum(axis=0) + NOTHING
        means = values @ shares / sizes
        variances = (shares * (values[:, None] - means) ** 2).sum(axis=0) / sizes + LEAST_VARIANCE
        weights = sizes / sizes.sum()
        if abs(bound - before) < tolerance:
            return weights, True
    return weights, False


def _start(samples: Array, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Weights and variances of the clusters that k-means finds (C,)."""
    from sklearn.exceptions import ConvergenceWarning

    with warnings.catch_warnings():
        # fewer distinct samples than clusters leave some empty: the fit starts from that too
        warnings.simplefilter("ignore", ConvergenceWarning)
        model = scikit_learn_start()(count, n_init=1, random_state=int(rng.integers(2**31)))
        labels = model.fit(samples[:, None]).labels_
    sizes = np.bincount(labels, minlength=count) + NOTHING
    means = np.bincount(labels, samples, count) / sizes
    squares = np.bincount(labels, (samples - means[labels]) ** 2, count)
    return sizes / sizes.sum(), squares / sizes + LEAST_VARIANCE


def _expectation(
    values: Array, counts: NDArray[np.intp], weights: Array, means: Array, variances: Array
) -> tuple[Array, float]:
    """How many samples of each value each component accounts for (V, C), and the mean log likelihood [nats]."""
    log_p = np.log(weights) - 0.5 * np.log(2 * np.pi * variances) - 0.5 * (values[:, None] - means) ** 2 / variances
    peak = log_p.max(axis=1, keepdims=True)
    p = np.exp(log_p - peak)
    total = p.sum(axis=1, keepdims=True)
    bound = float(counts @ (peak + np.log(total))[:, 0]) / float(counts.sum())
    return p * (counts[:, None] / total), bound


def weights_of(mixture: Mixture, density: Array, settings: Settings, rng: np.random.Generator) -> Array:
    """Weights of the components in a density (C,), by EM on samples of it.

    A fit that has not converged is made again with more samples and more iterations; the last one
    counts, converged or not.
    """
    samples = np.empty(0)
    for attempt in range(1, settings.refits + 2):
        samples = np.append(samples, mixture.grid.draw(density, settings.fit_samples, rng))
        iterations = attempt * settings.fit_iterations
        weights, converged = fit_weights(samples, mixture.means, iterations, settings.tolerance, rng)
        if converged:
            break
    return weights
