"""Channels over time."""

from __future__ import annotations

import numpy as np

from palpate.server.plots.drawing import COLOURS
from palpate.server.plots.plot import Curve, Numbers, Plot
from palpate.store.records import Channel

__all__ = ["channel_plot", "time_of", "unit_text"]


def channel_plot(channel: Channel) -> Plot | None:
    """A channel over time, each of its components as a curve; None where it is no curve, as an image is."""
    values = np.asarray(channel.values)
    if (
        values.dtype == np.bool_
        or values.ndim > 2
        or not values.size
        or values.reshape(len(values), -1).shape[1] > COLOURS
    ):
        return None
    lines = values.reshape(len(values), -1).astype(np.float64)
    times, told = time_of(channel)
    up = f"{channel.name} [{unit_text(channel.unit)}]"
    count = lines.shape[1]
    names = [channel.name] if count == 1 else [f"{channel.name} {place + 1} of {count}" for place in range(count)]
    curves = tuple(Curve(times, lines[:, place], name, place) for place, name in enumerate(names))
    return Plot(f"{up} over {told}", told, up, curves)


def unit_text(unit: str | None) -> str:
    """A unit as people read it."""
    return "unit not stated" if unit is None else unit


def time_of(channel: Channel) -> tuple[Numbers, str]:
    """Where each sample stands, and what that is."""
    count = len(channel.values)
    if channel.time_s is not None and np.isfinite(channel.time_s).all():
        return channel.time_s, "time [s]"
    places = np.arange(count, dtype=np.float64)
    if channel.rate_hz is not None:
        # no second copy of very many
        places /= channel.rate_hz
        return places, "time [s]"
    return places, "sample"
