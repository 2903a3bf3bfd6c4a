"""Sounds that were recorded as files, as channels that can be drawn."""

from __future__ import annotations

import io
import wave

import numpy as np

from palpate.store.records import Channel

__all__ = ["sound_in"]

KINDS = {2: "<i2", 4: "<i4"}


def sound_in(data: bytes) -> Channel | None:
    """The first channel of a WAV file between -1 and 1; None where it is no WAV file of whole numbers.

    Examples
    --------
    >>> sound_in(b"RIFF and nothing else") is None
    True
    """
    try:
        with wave.open(io.BytesIO(data)) as found:
            kind, channels, rate_hz = KINDS.get(found.getsampwidth()), found.getnchannels(), found.getframerate()
            frames = found.readframes(found.getnframes())
    except (wave.Error, EOFError):
        return None
    if kind is None or channels < 1 or rate_hz <= 0:
        return None
    samples = np.frombuffer(frames, kind, count=len(frames) // int(kind[-1]))[::channels]
    if not samples.size:
        return None
    values = samples.astype(np.float64) / np.iinfo(kind).max
    return Channel("sound", "sound pressure", None, values, rate_hz=float(rate_hz))
