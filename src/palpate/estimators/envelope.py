"""How the loudness of a sound goes: a knock is loudest at its beginning and dies away, a beep lasts and then ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.signals import SignalError

__all__ = ["FRAME_S", "check_dying", "until_noise"]

FRAME_S = 0.005
BEGUN_DB, FIRST_DB, SECOND_DB = 0.5, 10.0, 20.0
"""Levels of what is left of the energy: where the sound has begun, and after the first and the second fall."""
HOLDS = 0.5
"""A second fall that takes less than this share of the first one ends a sound that was held."""
LEAST_S, LEAST_PERIODS = 0.009, 4.0
"""A shorter sound, of fewer periods, falls as its few waves do, and nothing can be told of it."""
LOWEST_HZ = 50.0


def check_dying(sound: NDArray[np.float64], rate_hz: float, noise_rms: float) -> None:
    """Refuse a sound that is held and then ends, as beeps and bursts of noise do.

    The energy that is left of a sum of partials that die away, each at its own rate, falls ever more slowly in
    decibels, as the logarithm of a sum of exponentials is convex: a second fall by 10 dB takes no less time than the
    first. What is held for a while falls ever faster.

    Parameters
    ----------
    sound
        Samples from the onset on, (n).
    noise_rms
        Of the noise under it.

    Raises
    ------
    SignalError
        If it is held.

    Examples
    --------
    >>> seconds = np.arange(8000) / 16000
    >>> tone = np.sin(2 * np.pi * 1000 * seconds)
    >>> check_dying(tone * 10 ** (-3 * seconds / 0.2), 16000, 0.0)
    >>> check_dying(tone * (seconds < 0.05), 16000, 0.0)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    palpate.estimators.signals.SignalError: recording: a sound is held for 0.040 s and ends within 0.005 s; a knock ...
    """
    power = sound**2
    if noise_rms > 0:
        power = until_noise(power, rate_hz, noise_rms) - noise_rms**2
    left = np.cumsum(power[::-1])[::-1]
    if left.size == 0 or left[0] <= 0:
        return
    level_db = 10 * np.log10(np.maximum(left / left[0], 1e-12))
    below = [np.flatnonzero(level_db < -depth) for depth in (BEGUN_DB, FIRST_DB, SECOND_DB)]
    if not all(places.size for places in below):
        return
    begun, first, second = (float(places[0]) / rate_hz for places in below)
    held, ends = first - begun, second - first
    if ends < HOLDS * held and (held >= LEAST_S or held * _pitch_hz(sound[: power.size], rate_hz) >= LEAST_PERIODS):
        raise SignalError(
            f"recording: a sound is held for {held:.3f} s and ends within {ends:.3f} s; a knock dies away from its "
            "beginning on"
        )


def until_noise(power: NDArray[np.float64], rate_hz: float, noise_rms: float) -> NDArray[np.float64]:
    """The beginning, until the sound is as weak as the noise."""
    frame = max(int(FRAME_S * rate_hz), 1)
    levels = power[: power.size // frame * frame].reshape(-1, frame).mean(axis=1)
    weak = np.flatnonzero(levels < 2 * noise_rms**2)
    return power[: int(weak[0]) * frame] if weak.size else power


def _pitch_hz(sound: NDArray[np.float64], rate_hz: float) -> float:
    """The mean frequency of what can be heard."""
    spectrum, hertz = np.abs(np.fft.rfft(sound)) ** 2, np.fft.rfftfreq(sound.size, 1 / rate_hz)
    heard = hertz > LOWEST_HZ
    total = float(spectrum[heard].sum())
    return float(spectrum[heard] @ hertz[heard]) / total if total > 0 else 0.0
