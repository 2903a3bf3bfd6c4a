"""Mel spectrograms: power in bands that are as wide as they sound."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["from_mel", "mel_bands", "mel_picture", "mel_spectrogram", "to_mel"]

PICTURE_S, PICTURE_BANDS, DEEPEST_DB = 0.5, 64, 80.0


def to_mel(frequency_hz: ArrayLike) -> NDArray[np.float64]:
    """Mel of a frequency [Hz] (O'Shaughnessy 1987): 2595 log10(1 + f / 700).

    Examples
    --------
    >>> to_mel([0.0, 1000.0]).round(2)
    array([  0.  , 999.99])
    """
    found: NDArray[np.float64] = 2595.0 * np.log10(1.0 + np.asarray(frequency_hz, dtype=np.float64) / 700.0)
    return found


def from_mel(mel: ArrayLike) -> NDArray[np.float64]:
    """Frequency [Hz] of a mel."""
    found: NDArray[np.float64] = 700.0 * (10.0 ** (np.asarray(mel, dtype=np.float64) / 2595.0) - 1.0)
    return found


@lru_cache(maxsize=16)
def mel_bands(bands: int, length: int, rate_hz: float, low_hz: float = 50.0) -> NDArray[np.float64]:
    """Triangular weights, (bands, length // 2 + 1), of the frequencies of a transform of so many samples."""
    lowest, highest = to_mel([low_hz, rate_hz / 2])
    edges = from_mel(np.linspace(lowest, highest, bands + 2))
    hertz = np.fft.rfftfreq(length, 1 / rate_hz)
    left, centre, right = edges[:-2, None], edges[1:-1, None], edges[2:, None]
    rising, falling = (hertz - left) / (centre - left), (right - hertz) / (right - centre)
    weights: NDArray[np.float64] = np.maximum(0.0, np.minimum(rising, falling))
    # a band narrower than the grid of frequencies holds the nearest of them
    empty = weights.sum(axis=1) == 0
    weights[empty, np.abs(hertz - centre[empty]).argmin(axis=1)] = 1.0
    weights.setflags(write=False)
    return weights


def mel_spectrogram(
    sound: ArrayLike, rate_hz: float, *, bands: int = 64, window_s: float = 0.032, hop_s: float = 0.008
) -> NDArray[np.float64]:
    """Power by band and time, (bands, frames).

    Parameters
    ----------
    sound
        Samples, (n); the last frame is filled up with zeros.
    window_s, hop_s
        Length of a frame, and from one to the next [s].
    """
    values = np.asarray(sound, dtype=np.float64)
    length, hop = int(window_s * rate_hz), max(int(hop_s * rate_hz), 1)
    frames = 1 + max(0, -(-(values.size - length) // hop))
    padded = np.zeros((frames - 1) * hop + length)
    padded[: min(values.size, padded.size)] = values[: padded.size]
    cut = np.lib.stride_tricks.sliding_window_view(padded, length)[::hop]
    power = np.abs(np.fft.rfft(cut * np.hanning(length), axis=1)) ** 2 / length
    found: NDArray[np.float64] = mel_bands(bands, length, float(rate_hz)) @ power.T
    return found


def mel_picture(sound: ArrayLike, rate_hz: float) -> NDArray[np.uint8]:
    """A mel spectrogram as a grey image for networks that take images, (64, frames, 3), low bands at the bottom.

    Half a second of sound, silent where it ends sooner; white is the loudest, black 80 dB below it or less.

    Parameters
    ----------
    sound
        Samples from the onset on, (n).

    Examples
    --------
    >>> tone = np.sin(2 * np.pi * 1000 * np.arange(22050) / 44100)
    >>> picture = mel_picture(tone, 44100.0)
    >>> picture.shape, int(picture.max()), int(picture[0].max())
    ((64, 60, 3), 255, 0)
    """
    values, wanted = np.asarray(sound, dtype=np.float64), round(PICTURE_S * rate_hz)
    whole = np.zeros(wanted)
    whole[: min(values.size, wanted)] = values[:wanted]
    power = mel_spectrogram(whole, rate_hz, bands=PICTURE_BANDS)
    loudest = float(power.max())
    level_db = 10 * np.log10(np.maximum(power / loudest, 1e-30)) if loudest > 0 else np.full(power.shape, -np.inf)
    grey = np.round(255 * np.clip(1 + level_db / DEEPEST_DB, 0, 1)).astype(np.uint8)
    return np.repeat(grey[::-1, :, None], 3, axis=2)
