"""All results of a property as points with error bars, by what measured them, against what is known to be true."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from statistics import fmean

from markupsafe import Markup

from palpate.server.plots.drawing import COLOURS, Drawing, number
from palpate.server.plots.scale import Scale, spanning
from palpate.store.visible_results import Result

__all__ = ["points_plot"]

WIDTH, LEFT, RIGHT = 760.0, 180.0, 16.0
TOP, BOTTOM = 12.0, 44.0
LEAST_ROW, MOST_ROW = 34.0, 74.0
MOST_POINTS = 250
"""Of one device; of more, every so many are drawn."""


def points_plot(property: str, results: Sequence[Result], truths: Sequence[tuple[float, str]]) -> Markup | None:
    """Draw the values of one property, or return None where there is no value with a unit.

    Parameters
    ----------
    results
        Of that property.
    truths
        Values that are known, in the property's unit, each with its source.
    """
    groups: Mapping[str, list[Result]] = defaultdict(list)
    for result in results:
        if result.value is not None and not result.ground_truth:
            groups[result.measured_by].append(result)
    measured = [one for group in groups.values() for one in group]
    told = [*truths, *((one.value, "a recording") for one in results if one.ground_truth and one.value is not None)]
    if not measured:
        return None
    unit = measured[0].unit or ""
    height = sum(map(_row, groups.values()))
    drawing = Drawing(
        WIDTH, TOP + height + BOTTOM, f"{property} [{unit}]: {len(measured)} values by {len(groups)} devices"
    )
    ends = [end for one in measured for end in _ends(one)]
    across = spanning([*ends, *(value for value, _ in told)], LEFT, WIDTH - RIGHT)
    drawing.across_axis(across, TOP, TOP + height, f"{property} [{unit}]")
    top = TOP
    for colour, (name, group) in enumerate(sorted(groups.items())):
        _draw_group(drawing, across, top, name, group, f"c{colour % COLOURS}")
        top += _row(group)
    for value, _ in told:
        drawing.line(across.at(value), TOP, across.at(value), top, "truth")
        drawing.text(across.at(value) + 4, TOP + 8, f"true: {number(value)}", "truth-label")
    return drawing.markup()


def _ends(result: Result) -> tuple[float, float]:
    value, sd = result.value or 0.0, result.sd or 0.0
    return value - sd, value + sd


def _row(group: Sequence[Result]) -> float:
    return min(MOST_ROW, LEAST_ROW + len(group))


def _draw_group(drawing: Drawing, across: Scale, top: float, name: str, group: Sequence[Result], kind: str) -> None:
    shown = group[:: len(group) // MOST_POINTS + 1]
    values = [one.value for one in group if one.value is not None]
    height, mean = _row(group), fmean(values)
    drawing.text(LEFT - 10, top + height / 2, _short(name), "name", "end")
    drawing.text(LEFT - 10, top + height / 2 + 13, f"{number(mean)}, n = {len(values)}", "tick", "end")
    drawing.line(LEFT, top + height, WIDTH - RIGHT, top + height, "grid")
    step = (height - 16) / max(1, len(shown) - 1)
    for place, one in enumerate(shown):
        y = round(top + 8 + place * step if len(shown) > 1 else top + height / 2, 2)
        low, high = _ends(one)
        if high > low:
            drawing.line(across.at(low), y, across.at(high), y, f"bar {kind}")
        spread = f" ± {number(one.sd)}" if one.sd else ""
        told = f"{number(one.value or 0.0)}{spread} {one.unit}, {one.recorded_at:%Y-%m-%d}"
        drawing.dot(across.at(one.value or 0.0), y, kind, told, f"/recordings/{one.recording}")
    drawing.line(across.at(mean), top + 3, across.at(mean), top + height - 3, f"mean {kind}")


def _short(name: str, most: int = 24) -> str:
    return name if len(name) <= most else name[: most - 1] + "…"
