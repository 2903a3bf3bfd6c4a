"""From numbers to places in a plot, and the round numbers that stand at its axes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10

__all__ = ["Scale", "spanning"]

LARGEST = 1e300
"""So that differences are numbers too."""


@dataclass(frozen=True)
class Scale:
    """A linear scale from `low` at `start` to `high` at `end`."""

    low: float
    high: float
    start: float
    end: float

    def at(self, value: float) -> float:
        """The place of a value; of one outside, the end that it lies beyond.

        Examples
        --------
        >>> Scale(0.0, 10.0, 100.0, 200.0).at(2.5)
        125.0
        """
        share = (min(max(value, self.low), self.high) - self.low) / (self.high - self.low)
        return round(self.start + share * (self.end - self.start), 2)

    def ticks(self, most: int = 6) -> list[float]:
        """Round numbers, not more than `most` and one.

        Examples
        --------
        >>> Scale(0.0, 97.0, 0.0, 1.0).ticks()
        [0.0, 20.0, 40.0, 60.0, 80.0]
        """
        step = _round_up((self.high - self.low) / most)
        first = ceil(self.low / step - 1e-9)
        # the rounding errors of a product would be read as digits
        digits = max(0, -floor(log10(step)) + 1)
        last = floor(self.high / step + 1e-9)
        return [round(number * step, digits) for number in range(first, min(last, first + 2 * most) + 1)]


def spanning(values: Iterable[float], start: float, end: float, *, room: float = 0.05) -> Scale:
    """A scale on which all finite values lie, with some room at both ends."""
    found = [min(max(value, -LARGEST), LARGEST) for value in values if isfinite(value)]
    low, high = (min(found), max(found)) if found else (0.0, 1.0)
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        half = abs(low) / 10 or 1.0
        low, high = low - half, high + half
    more = room * (high - low)
    return Scale(low - more, high + more, start, end)


def _round_up(step: float) -> float:
    """The least of 1, 2 and 5 times a power of ten that is not less."""
    power = 10.0 ** floor(log10(step))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))
