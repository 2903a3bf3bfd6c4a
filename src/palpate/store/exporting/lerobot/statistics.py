"""Least, greatest, mean and spread of features: of an episode, and of all, merged as episodes come."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Moments", "image_moments", "moments"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Moments:
    """What is kept of many values: how many, their ends, their mean, and the sum of squared differences from it."""

    count: int
    low: Floats
    high: Floats
    mean: Floats
    squares: Floats

    def merged(self, other: Moments) -> Moments:
        """Of the values of both.

        By the pairwise update of Chan, Golub and LeVeque (1979), which loses no digits where means are large.
        """
        count = self.count + other.count
        off = other.mean - self.mean
        return Moments(
            count,
            np.minimum(self.low, other.low),
            np.maximum(self.high, other.high),
            self.mean + off * (other.count / count),
            self.squares + other.squares + off**2 * (self.count * other.count / count),
        )

    def plain(self) -> Mapping[str, Any]:
        """As the layout writes it; the spread is that of all values (n)."""
        numbers = {
            "min": self.low,
            "max": self.high,
            "mean": self.mean,
            "std": np.sqrt(self.squares / self.count),
        }
        return {**{name: array.tolist() for name, array in numbers.items()}, "count": [self.count]}


def moments(values: NDArray[Any]) -> Moments:
    """Of values, (n, k).

    Examples
    --------
    >>> moments(np.array([[1.0], [3.0]])).plain()
    {'min': [1.0], 'max': [3.0], 'mean': [2.0], 'std': [1.0], 'count': [2]}
    """
    numbers = np.asarray(values, dtype=np.float64)
    mean = numbers.mean(axis=0)
    return Moments(len(numbers), numbers.min(axis=0), numbers.max(axis=0), mean, ((numbers - mean) ** 2).sum(axis=0))


def image_moments(pixels: NDArray[np.uint8], frames: int) -> Moments:
    """Of an image in so many frames, by colour, (3, 1, 1), where 1 is the brightest."""
    own = moments(pixels.reshape(-1, 3) / 255.0)
    low, high, mean, squares = (part.reshape(3, 1, 1) for part in (own.low, own.high, own.mean, own.squares))
    return Moments(frames, low, high, mean, squares / own.count * frames)
