"""A sound as a picture: how loud it is at each pitch, over time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.store.pictures import png
from palpate.store.records import Channel

__all__ = ["spectrogram"]

WINDOW = 512
COLUMNS = 900
QUIETEST_DB = -80.0
DARK, BRIGHT = np.array([12.0, 16.0, 38.0]), np.array([255.0, 214.0, 102.0])


def spectrogram(channel: Channel) -> bytes:
    r"""Draw a channel as PNG, a column for each stretch of time, high pitches above.

    Examples
    --------
    >>> tone = np.sin(np.arange(9000) / 3)
    >>> spectrogram(Channel("sound", "sound pressure", "Pa", tone, rate_hz=8000.0))[:4]
    b'\x89PNG'
    """
    samples = np.asarray(channel.values)
    if len(samples) < WINDOW:
        samples = np.pad(samples, (0, WINDOW - len(samples)))
    count = min(COLUMNS, len(samples) // (WINDOW // 4))
    starts = np.linspace(0, len(samples) - WINDOW, count).astype(np.int64)
    # (time, window)
    windows = samples[starts[:, np.newaxis] + np.arange(WINDOW)].astype(np.float64)
    pieces = np.nan_to_num(windows) * np.hanning(WINDOW)
    power = np.abs(np.fft.rfft(pieces, axis=1)) ** 2
    loudest = float(power.max()) or 1.0
    level_db = 10 * np.log10(np.maximum(power / loudest, 1e-12))
    return png(_coloured(np.clip(1 - level_db / QUIETEST_DB, 0.0, 1.0)), "spectrogram")


def _coloured(level: NDArray[np.float64]) -> NDArray[np.uint8]:
    """From levels (time, pitch) to a picture (rows, columns, 3) with high pitches above."""
    upright = level.T[::-1, :, np.newaxis]
    return np.asarray(DARK + (BRIGHT - DARK) * upright, dtype=np.uint8)
