"""Results of a measurement: a number, a distribution over labels, an interval, a bound, or a failure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["Bound", "Distribution", "Entry", "FailedEntry", "Interval", "Value"]


@dataclass(frozen=True)
class Value:
    """A property with a number, its standard deviation where known, and the unit as given (None: nobody stated it)."""

    property: str
    value: float
    sd: float | None = None
    unit: str | None = None


@dataclass(frozen=True)
class Distribution:
    """A property with the probabilities of its labels, which sum to one."""

    property: str
    probabilities: Mapping[str, float]


@dataclass(frozen=True)
class Interval:
    """A property known to lie between two numbers."""

    property: str
    low: float
    high: float
    unit: str | None = None


@dataclass(frozen=True)
class Bound:
    """A property known to be above, or below, a number: exactly one of the two is given.

    Examples
    --------
    >>> Bound("elasticity", above=95.0, unit="kPa").below is None
    True
    """

    property: str
    above: float | None = None
    below: float | None = None
    unit: str | None = None


@dataclass(frozen=True)
class FailedEntry:
    """A measurement without a result, and why; of one property, or of all."""

    reason: str
    property: str | None = None


Entry = Value | Distribution | Interval | Bound | FailedEntry
