"""From features to probabilities of labels: one normal density a label, with a covariance that all share."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.estimators.signals import EstimatorError, SignalError
from palpate.outcomes import Failed, Posterior

__all__ = ["Classifier", "fit_classifier"]

SHRINKAGE = 0.1
FAR = 6.0
"""Features so many SDs, per feature, from every label are of something else."""


@dataclass(frozen=True, eq=False)
class Classifier:
    """Labels from features, by linear discriminants with equal priors.

    Attributes
    ----------
    names
        Of the features, d.
    labels
        k of them.
    means
        Of the features of each label, (k, d).
    precision
        Inverse of the covariance within labels, (d, d).
    temperature
        Of its probabilities, see `palpate.outcomes.Posterior`: above one where they are surer than right.
    source
        What it was fitted to, and how.
    """

    names: tuple[str, ...]
    labels: tuple[str, ...]
    means: NDArray[np.float64]
    precision: NDArray[np.float64]
    temperature: float = 1.0
    source: str = ""

    def outcome(self, features: ArrayLike) -> Posterior | Failed:
        """Probabilities of the labels, which sum to one, given features, (d); failed where they are like none of them.

        Its training prior is uniform.
        """
        try:
            squares = self._distances(features)
        except SignalError as error:
            return Failed(str(error))
        if squares.min() > FAR**2 * len(self.names):
            return Failed(f"features are {np.sqrt(squares.min() / len(self.names)):.1f} SDs from those of every label")
        scores = -0.5 * (squares - squares.min())
        probabilities = np.exp(scores) / np.exp(scores).sum()
        named = {label: float(p) for label, p in zip(self.labels, probabilities, strict=True)}
        return Posterior(named, temperature=self.temperature)

    def _distances(self, features: ArrayLike) -> NDArray[np.float64]:
        """Squared Mahalanobis distances from each label, (k)."""
        found = np.asarray(features, dtype=np.float64)
        if found.shape != (len(self.names),):
            raise EstimatorError(f"features: found shape {found.shape}, expected ({len(self.names)},)")
        if not np.all(np.isfinite(found)):
            bad = [name for name, value in zip(self.names, found, strict=True) if not np.isfinite(value)]
            raise SignalError(f"features: {', '.join(bad)} cannot be told from this signal")
        off = found - self.means
        distances: NDArray[np.float64] = np.einsum("ki,ij,kj->k", off, self.precision, off)
        return distances

    def save(self, path: str | Path) -> None:
        """Write it as JSON."""
        plain = {
            "source": self.source,
            "features": list(self.names),
            "labels": list(self.labels),
            "temperature": self.temperature,
            "means": self.means.tolist(),
            "precision": self.precision.tolist(),
        }
        Path(path).write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")

    @classmethod
    def load(cls, path: str | Path) -> Classifier:
        """Read what `save` wrote.

        Raises
        ------
        EstimatorError
            If it is something else.
        """
        try:
            plain = json.loads(Path(path).read_text(encoding="utf-8"))
            names, labels = tuple(plain["features"]), tuple(plain["labels"])
            means, precision = np.array(plain["means"], dtype=float), np.array(plain["precision"], dtype=float)
            temperature, source = float(plain.get("temperature", 1.0)), str(plain.get("source", ""))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise EstimatorError(f"{path}: cannot be read ({error}), expected what Classifier.save wrote") from None
        if means.shape != (len(labels), len(names)) or precision.shape != (len(names), len(names)):
            raise EstimatorError(f"{path}: its tables do not fit {len(labels)} labels and {len(names)} features")
        if not (np.all(np.isfinite(means)) and np.all(np.isfinite(precision)) and 0 < temperature < np.inf):
            raise EstimatorError(f"{path}: its numbers must be finite, and its temperature above 0")
        return cls(names, labels, means, precision, temperature, source)


def fit_classifier(
    features: ArrayLike, labels: Sequence[str], names: Sequence[str], *, shrinkage: float = SHRINKAGE
) -> Classifier:
    """Fit a classifier to examples.

    Parameters
    ----------
    features
        Examples, (n, d).
    labels
        Of the examples, n.
    names
        Of the features, d.
    shrinkage
        Share of the diagonal in the covariance (Friedman 1989), between 0 and 1: few examples tell little of the rest.

    Raises
    ------
    EstimatorError
        If the sizes do not fit, a number is not finite, or there are fewer than two labels or examples of each.

    Examples
    --------
    >>> fitted = fit_classifier([[0.0], [0.2], [5.0], [5.2]], ["dull", "dull", "ringing", "ringing"], ["decay"])
    >>> round(fitted.outcome([0.1]).probabilities["dull"], 3)
    1.0
    """
    found = np.asarray(features, dtype=np.float64)
    if found.ndim != 2 or found.shape != (len(labels), len(names)):
        raise EstimatorError(f"features: found shape {found.shape}, expected ({len(labels)}, {len(names)})")
    if not np.all(np.isfinite(found)):
        raise EstimatorError(f"features: {np.count_nonzero(~np.isfinite(found))} numbers are not finite")
    states = tuple(sorted(set(labels)))
    groups = [found[[label == state for label in labels]] for state in states]
    if len(states) < 2 or min(len(group) for group in groups) < 2:
        raise EstimatorError("labels: expected two at least, each with two examples or more")
    means = np.array([group.mean(axis=0) for group in groups])
    within = np.concatenate([group - mean for group, mean in zip(groups, means, strict=True)])
    covariance = within.T @ within / max(len(within) - len(states), 1)
    variances = np.maximum(np.diag(covariance), 1e-12)
    covariance = (1 - shrinkage) * covariance + shrinkage * np.diag(variances)
    covariance[np.diag_indices_from(covariance)] += 1e-9 * variances
    return Classifier(tuple(names), states, means, np.linalg.inv(covariance))
