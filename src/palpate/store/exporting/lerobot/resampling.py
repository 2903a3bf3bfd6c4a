"""Samples at moments at which there were none: the rules by which channels come to one rate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["Linear", "Nearest", "Resampling"]

Floats = NDArray[np.float64]


class Resampling(Protocol):
    """A rule that gives samples at other moments."""

    @property
    def words(self) -> str:
        """What a sample is, as it stands in the description of a data set."""

    def __call__(self, at_s: Floats, time_s: Floats, values: Floats) -> Floats:
        """Give the samples at some moments.

        Parameters
        ----------
        at_s
            The moments [s], (m), none before the first or after the last sample.
        time_s
            Times of the samples [s], (n), in order.
        values
            The samples, (n, k).

        Returns
        -------
        NDArray
            (m, k).
        """


@dataclass(frozen=True)
class Nearest:
    """The sample that is nearest in time; of two that are equally near, the earlier one.

    Examples
    --------
    >>> Nearest()(np.array([0.4, 0.5, 0.6]), np.array([0.0, 1.0]), np.array([[10.0], [20.0]])).ravel()
    array([10., 10., 20.])
    """

    words: str = "the sample nearest in time"

    def __call__(self, at_s: Floats, time_s: Floats, values: Floats) -> Floats:
        """The nearest samples."""
        after = np.clip(np.searchsorted(time_s, at_s), 1, max(1, len(time_s) - 1))
        before = after - 1
        after = np.minimum(after, len(time_s) - 1)
        later = time_s[after] - at_s < at_s - time_s[before]
        return np.asarray(values[np.where(later, after, before)])


@dataclass(frozen=True)
class Linear:
    """Straight lines between samples.

    Examples
    --------
    >>> Linear()(np.array([0.25]), np.array([0.0, 1.0]), np.array([[10.0], [20.0]])).ravel()
    array([12.5])
    """

    words: str = "interpolated linearly between the samples before and after"

    def __call__(self, at_s: Floats, time_s: Floats, values: Floats) -> Floats:
        """The samples on straight lines."""
        return np.column_stack([np.interp(at_s, time_s, column) for column in values.T])
