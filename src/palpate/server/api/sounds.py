"""Channels that can be heard, as sound files."""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from palpate.server.api.stretches import stretches
from palpate.store.records import Channel

__all__ = ["SoundFile", "is_sound"]

SLOWEST_SOUND_HZ, FASTEST_SOUND_HZ = 4_000, 2_000_000
SAMPLE_BYTES = 2
PIECE_SAMPLES = 1 << 18


def is_sound(channel: Channel) -> bool:
    """Whether a channel can be heard: evenly spaced samples, as many each second as a sound has.

    Examples
    --------
    >>> is_sound(Channel("sound", "sound pressure", "Pa", np.zeros(9), rate_hz=44_100.0))
    True
    """
    rate_hz = channel.rate_hz
    return rate_hz is not None and SLOWEST_SOUND_HZ <= rate_hz <= FASTEST_SOUND_HZ and channel.values.ndim == 1


class SoundFile:
    """A channel as a WAV file of 16 bits, made piece by piece; its loudest sample is full scale."""

    def __init__(self, channel: Channel) -> None:
        self._values = channel.values
        self._loudest = max((_loudest(channel.values[a:b]) for a, b, _ in stretches(channel)), default=0.0) or 1.0
        rate = round(channel.rate_hz or 0)
        form = struct.pack("<HHIIHH", 1, 1, rate, SAMPLE_BYTES * rate, SAMPLE_BYTES, 8 * SAMPLE_BYTES)
        data_bytes = SAMPLE_BYTES * len(channel.values)
        body = b"WAVEfmt " + struct.pack("<I", len(form)) + form + b"data" + struct.pack("<I", data_bytes)
        self._header = b"RIFF" + struct.pack("<I", len(body) + data_bytes) + body

    @property
    def size(self) -> int:
        """How many bytes there are."""
        return len(self._header) + SAMPLE_BYTES * len(self._values)

    def beginning(self, count: int) -> bytes:
        """The first bytes."""
        return b"".join(self.pieces(0, count))

    def pieces(self, start: int, end: int) -> Iterator[bytes]:
        """The bytes from one place to another."""
        head = len(self._header)
        if start < head:
            yield self._header[start:end]
        first, last = max(0, start - head), max(0, min(end, self.size) - head)
        while first < last:
            sample = first // SAMPLE_BYTES
            piece = self._samples(sample, sample + PIECE_SAMPLES)
            offset = first - sample * SAMPLE_BYTES
            taken = piece[offset : offset + last - first]
            yield taken
            first += len(taken)

    def _samples(self, start: int, stop: int) -> bytes:
        return (_finite(self._values[start:stop]) / self._loudest * 32767).astype("<i2").tobytes()


def _loudest(values: NDArray[np.generic]) -> float:
    return float(np.abs(_finite(values)).max(initial=0.0))


def _finite(values: NDArray[np.generic]) -> NDArray[np.float64]:
    return np.nan_to_num(np.asarray(values, dtype=np.float64))
