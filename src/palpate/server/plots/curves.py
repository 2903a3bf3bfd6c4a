"""Curves: channels over time, and a squeeze as force over the gap with the line that was fitted to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from palpate.estimators.hinge import Hinge, fit_hinge
from palpate.estimators.signals import SignalError
from palpate.server.plots.drawing import COLOURS, Drawing, number
from palpate.server.plots.scale import spanning
from palpate.store.records import Channel, Series

__all__ = ["channel_plot", "squeeze_of", "squeeze_plot"]

WIDTH, LEFT, RIGHT = 760.0, 64.0, 16.0
TOP, HEIGHT, BOTTOM = 26.0, 180.0, 44.0
COLUMNS = 500
GAP_SD_MM = 0.1
"""Of the jaws of a gripper, where nothing more is known."""
Numbers = NDArray[np.float64]


def channel_plot(channel: Channel) -> Markup | None:
    """Draw a channel over time, each of its components as a curve; None where it is no curve, as an image is."""
    values = np.asarray(channel.values)
    if (
        values.dtype == np.bool_
        or values.ndim > 2
        or not values.size
        or values.reshape(len(values), -1).shape[1] > COLOURS
    ):
        return None
    lines = values.reshape(len(values), -1).astype(np.float64)
    times, told = _times(channel)
    across = spanning([float(times[0]), float(times[-1])], LEFT, WIDTH - RIGHT, room=0.0)
    up = spanning([_least(lines), _most(lines)], TOP + HEIGHT, TOP)
    unit = "unit not stated" if channel.unit is None else channel.unit
    drawing = Drawing(WIDTH, TOP + HEIGHT + BOTTOM, f"{channel.name} [{unit}] over {told}")
    drawing.across_axis(across, TOP, TOP + HEIGHT, told)
    drawing.up_axis(up, LEFT, WIDTH - RIGHT, f"{channel.name} [{unit}]")
    for place in range(lines.shape[1]):
        for x, y in _pieces(*_thinned(times, lines[:, place])):
            drawing.curve(((across.at(a), up.at(b)) for a, b in zip(x, y, strict=True)), f"curve c{place}")
    return drawing.markup()


@dataclass(frozen=True)
class FoundSqueeze:
    """Gap [mm] and force [N] of a squeeze, (n), and the line through them; None where none could be fitted."""

    gap_mm: Numbers
    force_n: Numbers
    hinge: Hinge | None


def squeeze_of(series: Series) -> FoundSqueeze | None:
    """Force over the gap, where a series has one channel in mm and one in N that were sampled together."""
    gaps = [one for one in series.channels if one.unit == "mm" and one.values.ndim == 1]
    forces = [one for one in series.channels if one.unit == "N" and one.values.ndim == 1]
    if len(gaps) != 1 or len(forces) != 1 or len(gaps[0].values) != len(forces[0].values):
        return None
    gap, force = (np.asarray(one[0].values, dtype=np.float64) for one in (gaps, forces))
    if not (len(gap) and np.isfinite(gap).all() and np.isfinite(force).all()):
        return None
    end = int(np.argmin(gap)) + 1
    try:
        return FoundSqueeze(gap, force, fit_hinge(gap[:end], force[:end], gap_sd=GAP_SD_MM, force_sd=None))
    except (SignalError, ValueError, np.linalg.LinAlgError):
        return FoundSqueeze(gap, force, None)


def squeeze_plot(found: FoundSqueeze) -> Markup:
    """Draw force over the gap with the fitted line."""
    across = spanning(found.gap_mm.tolist(), LEFT, WIDTH - RIGHT)
    up = spanning(found.force_n.tolist(), TOP + HEIGHT, TOP)
    drawing = Drawing(WIDTH, TOP + HEIGHT + BOTTOM, "force [N] over the gap of the jaws [mm]")
    drawing.across_axis(across, TOP, TOP + HEIGHT, "gap [mm]")
    drawing.up_axis(up, LEFT, WIDTH - RIGHT, "force [N]")
    x, y = found.gap_mm[:: len(found.gap_mm) // COLUMNS + 1], found.force_n[:: len(found.force_n) // COLUMNS + 1]
    drawing.curve(((across.at(a), up.at(b)) for a, b in zip(x, y, strict=True)), "curve c0")
    if found.hinge is not None:
        knots = [float(found.gap_mm.max()), found.hinge.contact, float(found.gap_mm.min())]
        heights = [found.hinge.idle_force, found.hinge.idle_force]
        heights.append(found.hinge.idle_force + found.hinge.slope * (found.hinge.contact - knots[2]))
        drawing.curve(((across.at(a), up.at(b)) for a, b in zip(knots, heights, strict=True)), "fit")
        told = f"fitted: {number(found.hinge.slope)} N/mm from contact at {number(found.hinge.contact)} mm"
        drawing.text(WIDTH - RIGHT, TOP - 8, told, "label", "end")
    return drawing.markup()


def _times(channel: Channel) -> tuple[Numbers, str]:
    """Where each sample stands, and what that is."""
    count = len(channel.values)
    if channel.time_s is not None and np.isfinite(channel.time_s).all():
        return channel.time_s, "time [s]"
    if channel.rate_hz is not None:
        return np.arange(count) / channel.rate_hz, "time [s]"
    return np.arange(count, dtype=np.float64), "sample"


def _least(values: Numbers) -> float:
    return float(np.nanmin(values)) if np.isfinite(values).any() else 0.0


def _most(values: Numbers) -> float:
    return float(np.nanmax(values)) if np.isfinite(values).any() else 1.0


def _thinned(x: Numbers, y: Numbers) -> tuple[Numbers, Numbers]:
    """Of very many samples the least and the greatest of each stretch, so that no peak is lost."""
    if len(y) <= 2 * COLUMNS:
        return x, y
    stretches = np.array_split(np.where(np.isfinite(y), y, 0.0), COLUMNS)
    start, places = 0, []
    for part in stretches:
        places += sorted((start + int(part.argmin()), start + int(part.argmax())))
        start += len(part)
    return x[places], y[places]


def _pieces(x: Numbers, y: Numbers) -> Sequence[tuple[Numbers, Numbers]]:
    """A curve without its missing samples: a gap is a gap."""
    there = np.isfinite(y) & np.isfinite(x)
    cuts = np.flatnonzero(np.diff(there.astype(np.int8))) + 1
    parts = zip(np.split(x, cuts), np.split(y, cuts), np.split(there, cuts), strict=True)
    return [(a, b) for a, b, fine in parts if len(fine) and fine[0]]
