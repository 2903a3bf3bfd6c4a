"""A plot as a picture that stands in a page, so that it is there without JavaScript and in print."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from palpate.server.plots.drawing import COLOURS, MOST_OF_ROW, Drawing
from palpate.server.plots.levels import GAP, LINE, Labelled, in_lines
from palpate.server.plots.plot import Curve, Look, Numbers, Plot, Point, thinned
from palpate.server.plots.scale import Scale, spanning

__all__ = ["HEIGHT", "LEFT", "LEFT_OF_ROWS", "svg"]

WIDTH, RIGHT, BOTTOM = 760.0, 16.0, 44.0
LEFT, TOP, HEIGHT = 64.0, 26.0, 180.0
LEFT_OF_ROWS, TOP_OF_ROWS = 190.0, 12.0
STRETCHES = 500


def svg(plot: Plot) -> Markup:
    """Draw a plot."""
    return _in_rows(plot) if plot.rows else _curves(plot)


def _curves(plot: Plot) -> Markup:
    bottom = TOP + HEIGHT
    drawing = Drawing(WIDTH, bottom + BOTTOM, plot.title)
    across = spanning(plot.ends_across(), LEFT, WIDTH - RIGHT, room=0.02)
    up = spanning(plot.ends_up(), bottom, TOP)
    drawing.across_axis(across, TOP, bottom, plot.across)
    drawing.up_axis(up, LEFT, WIDTH - RIGHT, plot.up or "")
    _lines(drawing, plot, across, up)
    if plot.note:
        drawing.text(WIDTH - RIGHT, TOP - 8, plot.note, "label", "end")
    return drawing.markup()


def _in_rows(plot: Plot) -> Markup:
    height = plot.rows[-1].bottom
    across = spanning(plot.ends_across(), LEFT_OF_ROWS, WIDTH - RIGHT)
    levels = in_lines(plot.levels, across)
    top = TOP_OF_ROWS + LINE * max((one.line + 1 for one in levels if one.line is not None), default=0)
    bottom = top + height
    drawing = Drawing(WIDTH, bottom + BOTTOM, plot.title)
    down = Scale(0.0, height, top, bottom)
    drawing.across_axis(across, top, bottom, plot.across)
    for row in plot.rows:
        middle = down.at((row.top + row.bottom) / 2)
        drawing.text(LEFT_OF_ROWS - 10, middle + (0 if row.note else 4), row.name, "name", "end", MOST_OF_ROW)
        if row.note:
            drawing.text(LEFT_OF_ROWS - 10, middle + 13, row.note, "tick", "end")
        drawing.line(LEFT_OF_ROWS, down.at(row.bottom), WIDTH - RIGHT, down.at(row.bottom), "grid")
    for point in plot.points:
        _point(drawing, point, across, down)
    _lines(drawing, plot, across, down)
    for one in levels:
        _level(drawing, one, across.at(one.level.x), top, bottom)
    return drawing.markup()


def _level(drawing: Drawing, one: Labelled, x: float, top: float, bottom: float) -> None:
    if one.line is None:
        drawing.line(x, top, x, bottom, "truth", one.level.label)
        return
    foot = top - LINE * one.line
    drawing.line(x, foot - LINE, x, bottom, "truth", one.level.label)
    aside, anchor = (-GAP, "end") if one.at_left else (GAP, "start")
    drawing.text(x + aside, foot - GAP, one.level.label, "truth-label", anchor)


def _point(drawing: Drawing, point: Point, across: Scale, down: Scale) -> None:
    kind, y = f"c{point.colour % COLOURS}", down.at(point.y)
    if point.high > point.low:
        drawing.line(across.at(point.low), y, across.at(point.high), y, f"bar {kind}")
    drawing.dot(across.at(point.x), y, kind, point.told, point.link)


def _lines(drawing: Drawing, plot: Plot, across: Scale, up: Scale) -> None:
    for curve in plot.curves:
        kind = curve.look.value if curve.look is Look.FITTED else f"{curve.look.value} c{curve.colour % COLOURS}"
        for x, y in _pieces(curve):
            drawing.curve(((across.at(a), up.at(b)) for a, b in zip(x.tolist(), y.tolist(), strict=True)), kind)


def _pieces(curve: Curve) -> Iterator[tuple[Numbers, Numbers]]:
    """A curve without its missing samples: a gap is a gap."""
    x, y = thinned(curve.x, curve.y, STRETCHES)
    there = np.isfinite(y) & np.isfinite(x)
    cuts = np.flatnonzero(np.diff(there.astype(np.int8))) + 1
    for a, b, fine in zip(np.split(x, cuts), np.split(y, cuts), np.split(there, cuts), strict=True):
        if len(fine) and fine[0]:
            yield a, b
