"""What a plot shows: one description, from which the picture in the page and the figure that one can zoom are made."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

__all__ = ["Curve", "Level", "Look", "Numbers", "Plot", "Point", "Row", "thinned"]

Numbers = NDArray[np.float64]


class Look(Enum):
    """What a curve stands for, which is how it looks; the values are the classes of the style sheet."""

    MEASURED = "curve"
    FITTED = "fit"
    MEAN = "mean"


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points, (n); one that is not finite is a gap. `colour` is its place among those of the page."""

    x: Numbers
    y: Numbers
    name: str
    colour: int = 0
    look: Look = Look.MEASURED


@dataclass(frozen=True)
class Point:
    """A value across, at a height; `low` and `high` are the ends of its error bar.

    Attributes
    ----------
    told
        What it is, in words.
    link
        The page that it leads to.
    """

    x: float
    y: float
    low: float
    high: float
    told: str
    link: str
    colour: int = 0


@dataclass(frozen=True)
class Level:
    """A value across that is known to be true."""

    x: float
    label: str = ""


@dataclass(frozen=True)
class Row:
    """A stretch of the height that belongs to somebody, from `top` down to `bottom`; `note` is a second line."""

    name: str
    note: str
    top: float
    bottom: float


@dataclass(frozen=True)
class Plot:
    """A plot: what is drawn, and what the axes are.

    Attributes
    ----------
    title
        What there is to see, for those who cannot.
    across, up
        What the axes are, with units; `up` is None where there are rows.
    rows
        From the top down; heights of points are between their ends then, and grow downwards.
    note
        A few words about the curves.
    """

    title: str
    across: str
    up: str | None = None
    curves: tuple[Curve, ...] = ()
    points: tuple[Point, ...] = ()
    levels: tuple[Level, ...] = ()
    rows: tuple[Row, ...] = ()
    note: str = ""

    def ends_across(self) -> list[float]:
        """The least and the greatest of what is drawn, of each part of it."""
        curves = [end for one in self.curves for end in _ends(one.x)]
        bars = [end for one in self.points for end in (one.low, one.high)]
        return [*curves, *bars, *(one.x for one in self.levels)]

    def ends_up(self) -> list[float]:
        """Likewise upwards, of the curves."""
        return [end for one in self.curves for end in _ends(one.y)]


def _ends(values: Numbers) -> tuple[float, ...]:
    there = values[np.isfinite(values)]
    return (float(there.min()), float(there.max())) if there.size else ()


def thinned(x: Numbers, y: Numbers, stretches: int) -> tuple[Numbers, Numbers]:
    """Of very many samples the least and the greatest of each stretch, so that no peak is lost.

    Samples that are missing are passed over; where a whole stretch is missing, there is a gap.

    Examples
    --------
    >>> x, y = np.arange(900.0), np.zeros(900)
    >>> y[123], y[::9] = 7, np.nan
    >>> len(thinned(x, y, 10)[0]), thinned(x, y, 10)[1].max()
    (20, np.float64(7.0))
    """
    if len(y) <= 2 * stretches:
        return x, y
    places, ends = list[int](), np.linspace(0, len(y), stretches + 1).astype(np.int64).tolist()
    # stretch by stretch, so that no copies of all samples are made
    for start, end in pairwise(ends):
        here = y[start:end]
        there = np.isfinite(x[start:end]) & np.isfinite(here)
        # of a stretch that is missing these are its first sample, which is missing too
        places += sorted(
            (start + int(np.where(there, here, np.inf).argmin()), start + int(np.where(there, here, -np.inf).argmax()))
        )
    return x[places], y[places]
