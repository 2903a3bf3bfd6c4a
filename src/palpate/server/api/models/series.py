"""The forms of series, with their samples and without."""

from __future__ import annotations

from typing import Any

from palpate.server.api.models.basics import Strict

__all__ = ["SeriesInfo", "SeriesSamples"]


class Channel(Strict):
    """Samples of one quantity, without the samples."""

    name: str
    quantity: str
    unit: str | None
    rate_hz: float | None
    timed: bool
    shape: list[int]


class SeriesInfo(Strict):
    """A series without its samples; `position` is its place in the recording."""

    position: int
    name: str
    channels: list[Channel]
    url: str


class ChannelSamples(Channel):
    """Samples of one quantity: values as nested lists, null where a sample is missing."""

    values: list[Any]
    time_s: list[float] | None


class SeriesSamples(Strict):
    """A series with its samples."""

    name: str
    channels: list[ChannelSamples]
