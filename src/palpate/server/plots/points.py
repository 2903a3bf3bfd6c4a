"""All results of a property as points with error bars, by what measured them, against what is known to be true."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from statistics import fmean

import numpy as np

from palpate.errors import plural
from palpate.server.plots.drawing import number, with_sd
from palpate.server.plots.levels import known_levels
from palpate.server.plots.plot import Curve, Look, Plot, Point, Row
from palpate.store.visible_results import Result

__all__ = ["points_plot"]

LEAST_ROW, MOST_ROW = 34.0, 74.0
MOST_POINTS = 250
"""Of one device; of more, every so many are drawn."""


def points_plot(
    property: str, results: Sequence[Result], truths: Sequence[tuple[float, str]], colours: Mapping[str, int]
) -> Plot | None:
    """The values of one property, or None where there is no value with a unit.

    Parameters
    ----------
    results
        Of that property.
    truths
        Values that are known, in the property's unit, each with its source.
    colours
        That of each device.
    """
    groups: Mapping[str, list[Result]] = defaultdict(list)
    for result in results:
        if result.value is not None and not result.ground_truth:
            groups[result.measured_by].append(result)
    if not groups:
        return None
    count = sum(map(len, groups.values()))
    unit = next(iter(groups.values()))[0].unit or ""
    recorded = [one for one in results if one.ground_truth and one.value is not None]
    told = [*truths, *((one.value or 0.0, one.owner or "a recording") for one in recorded)]
    rows, means = [], []
    points: list[Point] = []
    top = 0.0
    for name, group in sorted(groups.items()):
        colour = colours[name]
        mean, bottom = fmean(one.value or 0.0 for one in group), top + _height(group)
        rows.append(Row(name, f"{number(mean)}, n = {len(group)}", top, bottom))
        points += _points(group, top, bottom, colour)
        stretch = np.array([top + 3, bottom - 3])
        means.append(Curve(np.full(2, mean), stretch, name, colour, Look.MEAN))
        top = bottom
    return Plot(
        title=f"{property} [{unit}]: {plural(count, 'value')} by {plural(len(groups), 'device')}",
        across=f"{property} [{unit}]",
        rows=tuple(rows),
        points=tuple(points),
        curves=tuple(means),
        levels=known_levels(told),
    )


def _height(group: Sequence[Result]) -> float:
    return min(MOST_ROW, LEAST_ROW + len(group))


def _points(group: Sequence[Result], top: float, bottom: float, colour: int) -> Iterator[Point]:
    shown = group[:: len(group) // MOST_POINTS + 1]
    step = (bottom - top - 16) / max(1, len(shown) - 1)
    for place, one in enumerate(shown):
        y = top + 8 + place * step if len(shown) > 1 else (top + bottom) / 2
        value, sd = one.value or 0.0, one.sd or 0.0
        told = f"{with_sd(value, one.sd or None)} {one.unit}, {one.recorded_at:%Y-%m-%d}"
        yield Point(value, y, value - sd, value + sd, told, f"/recordings/{one.recording}", colour)
