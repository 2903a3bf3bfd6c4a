"""Sounds and images of recordings as files that lose nothing."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.recorded_sound import one_channel

__all__ = ["pixels_of", "sound_of", "wav"]

FULL_SCALE = 32768


def wav(samples: NDArray[np.float64], rate_hz: float) -> bytes:
    """A sound as a WAV file: of 16 bits where samples between -1 and 1 have no more, else of 64-bit floats.

    Examples
    --------
    >>> samples, rate_hz = sound_of(wav(np.array([0.0, 0.5, 0.1]), 44100.0))
    >>> samples.tolist(), rate_hz
    ([0.0, 0.5, 0.1], 44100.0)
    """
    from scipy.io import wavfile

    scaled = samples * FULL_SCALE
    is_whole = bool(np.all(scaled == np.round(scaled)) and np.all((scaled >= -FULL_SCALE) & (scaled < FULL_SCALE)))
    written = io.BytesIO()
    wavfile.write(written, round(rate_hz), scaled.astype(np.int16) if is_whole else samples)
    return written.getvalue()


def sound_of(data: bytes) -> tuple[NDArray[np.float64], float]:
    """Samples of a WAV file, (n), and their rate [Hz]."""
    from scipy.io import wavfile

    rate_hz, found = wavfile.read(io.BytesIO(data))
    return one_channel(found), float(rate_hz)


def pixels_of(data: bytes) -> NDArray[np.uint8]:
    """Red, green and blue of an image file, (height, width, 3)."""
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=np.uint8)
