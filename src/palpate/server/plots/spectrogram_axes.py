"""A spectrogram with its axes: time, pitch, and how loud a colour is."""

from __future__ import annotations

from markupsafe import Markup

from palpate.server.plots.drawing import Drawing
from palpate.server.plots.scale import Scale
from palpate.server.plots.spectrogram import QUIETEST_DB
from palpate.store.records import Channel

__all__ = ["spectrogram_with_axes"]

WIDTH, HEIGHT = 760.0, 260.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 16.0, 26.0, 44.0
HZ_PER_KHZ = 1e3


def spectrogram_with_axes(sound: Channel, name: str, address: str) -> Markup:
    """The picture at an address, which is that of a sound, in its axes.

    Examples
    --------
    >>> import numpy as np
    >>> tone = Channel("sound", "sound pressure", "Pa", np.zeros(4000), rate_hz=8000.0)
    >>> "pitch [kHz]" in spectrogram_with_axes(tone, "a tone", "/a.png")
    True
    """
    rate_hz = sound.rate_hz or 1.0
    drawing = Drawing(WIDTH, HEIGHT, f"Spectrogram of {name}: time across, pitch upwards, bright is loud")
    across = Scale(0.0, len(sound.values) / rate_hz, LEFT, WIDTH - RIGHT)
    up = Scale(0.0, rate_hz / 2 / HZ_PER_KHZ, HEIGHT - BOTTOM, TOP)
    drawing.across_axis(across, TOP, HEIGHT - BOTTOM, "time [s]")
    drawing.up_axis(up, LEFT, WIDTH - RIGHT, "pitch [kHz]")
    drawing.image(LEFT, TOP, WIDTH - RIGHT - LEFT, HEIGHT - BOTTOM - TOP, address)
    scale = f"brightest: the loudest, 0 dB; darkest: {abs(QUIETEST_DB):g} dB below it, and less"
    drawing.text(WIDTH - RIGHT, TOP - 8, scale, "label", "end")
    return drawing.markup()
