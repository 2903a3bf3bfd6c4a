"""A channel in stretches, so that an answer takes little memory however long the channel is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from palpate.store.records import Channel

__all__ = ["stretches"]

NUMBERS = 1 << 16
"""Of a stretch, or one sample where that has more."""


def stretches(channel: Channel) -> Iterator[tuple[int, int, NDArray[np.float64] | None]]:
    """First sample, the one after the last, and the time of each [s], None where it is not known.

    Samples that have no numbers have no stretch.

    Examples
    --------
    >>> channel = Channel("force", "force", "N", np.zeros(100_000), rate_hz=50_000.0)
    >>> [(start, stop, float(times[0])) for start, stop, times in stretches(channel)]
    [(0, 65536, 0.0), (65536, 100000, 1.31072)]
    """
    count = len(channel.values)
    each = channel.values.size // count if count else 0
    step = max(1, NUMBERS // each) if each else 1
    for start in range(0, count if each else 0, step):
        stop = min(count, start + step)
        yield start, stop, _seconds(channel, start, stop)


def _seconds(channel: Channel, start: int, stop: int) -> NDArray[np.float64] | None:
    if channel.time_s is not None:
        return channel.time_s[start:stop]
    return None if channel.rate_hz is None else np.arange(start, stop) / channel.rate_hz
