"""Sounds of messages as one file: samples as WAV, encoded pieces as they are."""

from __future__ import annotations

import struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from palpate.errors import choices
from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, member
from palpate.store.importing.bags.files import Spill, item
from palpate.store.importing.bags.images import bytes_in
from palpate.store.importing.bags.topics import SoundFrom
from palpate.store.records import FileItem

__all__ = ["Sound"]

ARRAYS = ("float32_data", "int32_data", "int24_data", "int16_data", "int8_data", "uint8_data")
"""Fields for samples of one type each, of which one is filled."""

TYPES = {"float32_data": "<f4", "int32_data": "<i4", "int16_data": "<i2", "uint8_data": "|u1"}
"""The types of samples that WAV has, too."""

LARGEST_BYTES = (1 << 32) - 64


class Facts(NamedTuple):
    """What samples are."""

    rate_hz: int | None
    channels: int | None
    sample: np.dtype[Any] | None


class Sound:
    """Puts the pieces of a sound together.

    A piece is bytes (``audio_common_msgs/AudioData`` or ``AudioDataStamped``), whose meaning the map tells, or
    samples with their rate (``AudioStamped``).
    """

    def __init__(self, wanted: SoundFrom, where: str) -> None:
        self.wanted, self.where = wanted, where
        self._pieces: list[tuple[int, bytes]] = []
        self._facts = Facts(wanted.rate_hz, wanted.channels, wanted.sample)

    def take(self, message: Any, log_ns: int) -> None:
        """Add the piece of a message; StoreError where it is of another kind than those before."""
        self._pieces.append((log_ns, self._piece(message)))

    @property
    def counts(self) -> str:
        """What `beginnings` counts."""
        return "first_sample" if self._is_wav else "first_byte"

    def beginnings(self) -> NDArray[np.int64]:
        """At which sample (of all channels), or byte, of the file each piece begins."""
        sizes = np.array([len(piece) for piece in self._ordered], np.int64)
        return (np.cumsum(sizes) - sizes) // (self._frame if self._is_wav else 1)

    def item(self, spill: Spill) -> FileItem:
        """The whole sound as a file.

        Raises
        ------
        StoreError
            If it should be WAV, and neither the map nor the messages tell what its samples are.
        """
        data = b"".join(self._ordered)
        return item(self.wanted.file, spill.keep(self._wav(data) if self._is_wav else data))

    def _piece(self, message: Any) -> bytes:
        audio, info = message, MISSING
        while (inner := _inner(audio)) is not MISSING:
            info = member(audio, "info") if info is MISSING else info
            audio = inner
        data = member(audio, "data")
        if data is not MISSING:
            return bytes_in(data, f"{self.where}.data")
        for name in ARRAYS:
            samples = member(audio, name)
            if samples is not MISSING and len(samples):
                return self._packed(name, samples, info)
        if member(audio, ARRAYS[0]) is MISSING:
            raise StoreError(f"{self.where}: holds no sound, expected a message such as audio_common_msgs/AudioData")
        return b""

    def _packed(self, name: str, samples: Any, info: Any) -> bytes:
        if name not in TYPES:
            raise StoreError(f"{self.where}: samples in {name}, which is not supported; {choices(TYPES)}")
        dtype = np.dtype(TYPES[name])
        known = self._facts
        rate_hz, channels = _count(info, "rate") or known.rate_hz, _count(info, "channels") or known.channels
        self._facts = Facts(rate_hz, channels, dtype)
        for key, old, new in zip(Facts._fields, known, self._facts, strict=True):
            if old not in (None, new):
                raise StoreError(f"{self.where}: {key} is {new} in a message and {old} before it, expected one sound")
        return np.asarray(samples).astype(dtype, casting="same_kind").tobytes()

    @property
    def _ordered(self) -> list[bytes]:
        return [piece for _, piece in sorted(self._pieces, key=lambda one: one[0])]

    @property
    def _is_wav(self) -> bool:
        return self.wanted.file.lower().endswith(".wav")

    @property
    def _frame(self) -> int:
        """Bytes of one sample of all channels."""
        for name, fact in self._facts._asdict().items():
            if fact is None:
                raise StoreError(f"{self.where}: its messages do not tell {name}, expected it in the map at the file")
        assert self._facts.channels is not None
        assert self._facts.sample is not None
        return self._facts.channels * self._facts.sample.itemsize

    def _wav(self, data: bytes) -> bytes:
        """Samples with the header of a WAV file; integers are format 1, floats 3."""
        frame, (rate_hz, _, dtype) = self._frame, self._facts
        assert rate_hz is not None
        assert dtype is not None
        if len(data) > LARGEST_BYTES or len(data) % frame or frame > 0xFFFF or rate_hz * frame > 0xFFFFFFFF:
            found = f"{len(data)} bytes for samples of {frame} bytes at {rate_hz} Hz"
            raise StoreError(f"{self.where}: {found}, expected whole samples, and less than 4 GiB")
        kind, bits = 3 if dtype.kind == "f" else 1, 8 * dtype.itemsize
        form = struct.pack("<HHIIHH", kind, frame // dtype.itemsize, rate_hz, rate_hz * frame, frame, bits)
        return _chunk(b"RIFF", b"WAVE" + _chunk(b"fmt ", form) + _chunk(b"data", data))


def _inner(audio: Any) -> Any:
    found = member(audio, "audio")
    return member(audio, "audio_data") if found is MISSING else found


def _count(info: Any, name: str) -> int | None:
    """What an AudioInfo tells, where it does."""
    found = member(info, name)
    return found if isinstance(found, int) and found > 0 else None


def _chunk(name: bytes, data: bytes) -> bytes:
    return name + struct.pack("<I", len(data)) + data + len(data) % 2 * b"\0"
