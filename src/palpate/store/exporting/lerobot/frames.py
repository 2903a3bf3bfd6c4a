"""The state of a recording at moments that are evenly spaced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.store.errors import StoreError
from palpate.store.exporting.lerobot.features import Signal
from palpate.store.exporting.lerobot.resampling import Resampling
from palpate.store.records import Channel, Recording

__all__ = ["Timing", "state_of"]

MOST_FRAMES = 1_000_000
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Timing:
    """How samples become frames.

    Attributes
    ----------
    fps
        Frames per second.
    resampling
        What a channel is at the moment of a frame.
    assumed_rate_hz
        Samples per second [Hz] of a channel that states neither a rate nor time stamps.
    """

    fps: int
    resampling: Resampling
    assumed_rate_hz: float | None = None


def state_of(recording: Recording, signals: Sequence[Signal], timing: Timing) -> NDArray[np.float32]:
    """All signals at the moments of the frames, (n, k): from when all have begun to when the first ends.

    Samples that are no finite numbers of 32 bits are passed over as if they were not there.

    Raises
    ------
    StoreError
        If there is no such moment, or there are too many.
    """
    channels = {(series.name, channel.name): channel for series in recording.series for channel in series.channels}
    missing = [signal for signal in signals if (signal.series, signal.channel) not in channels]
    if missing:
        raise StoreError(f"{missing[0].series}.{missing[0].channel} is not in it")
    sampled = [_samples(channels[signal.series, signal.channel], timing) for signal in signals]
    if not all(len(time_s) for time_s, _ in sampled):
        raise StoreError("a channel has no finite samples")
    start = max((time_s[0] for time_s, _ in sampled), default=0.0)
    end = min((time_s[-1] for time_s, _ in sampled), default=0.0)
    if start > end:
        raise StoreError("its channels have no moment in common")
    # a frame at the very end counts, whatever the last digit
    last = (end - start) * timing.fps + 1e-6
    if not last < MOST_FRAMES:
        raise StoreError(f"{last:.3g} frames, expected at most {MOST_FRAMES}")
    at_s = start + np.arange(int(last) + 1) / timing.fps
    columns = [timing.resampling(at_s, time_s, values) for time_s, values in sampled]
    if not columns:
        return np.empty((len(at_s), 0), dtype=np.float32)
    return np.hstack(columns).astype(np.float32)


def _samples(channel: Channel, timing: Timing) -> tuple[Floats, Floats]:
    """Times and samples of a channel, (n) and (n, k), in order of time."""
    values = channel.values.reshape(len(channel.values), -1)
    with np.errstate(over="ignore"):
        kept = np.isfinite(values.astype(np.float32)).all(axis=1)
    if channel.time_s is not None:
        time_s = channel.time_s
    else:
        rate_hz = channel.rate_hz or timing.assumed_rate_hz
        if rate_hz is None:
            raise StoreError(f"{channel.name} has neither a rate nor time stamps")
        time_s = np.arange(len(values)) / rate_hz
    order = np.argsort(time_s[kept], kind="stable")
    return time_s[kept][order], values[kept][order].astype(np.float64)
