"""Whether the raw signals of a recording fit together."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from palpate.store.errors import StoreError
from palpate.store.quantities import check_quantity
from palpate.store.records import Channel, Series
from palpate.store.texts import check_name, check_number

__all__ = ["check_series"]

NUMBERS = "biuf"


def check_series(series: Iterable[Series], *, are_new: bool = True) -> None:
    """Refuse channels that do not fit together.

    Parameters
    ----------
    series
        What was recorded.
    are_new
        Whether no store has had them: then their units have the dimensions that everybody knows.

    Raises
    ------
    StoreError
        Naming the channel: a name given twice, a unit that is unknown or of another dimension than the quantity,
        samples that are not numbers, other than as many time stamps as samples, a rate that is not positive, or
        channels of one rate with different numbers of samples.
    """
    names: set[str] = set()
    for place, one in enumerate(series):
        where = f"series[{place}]"
        check_name(f"{where}.name", one.name)
        if one.name in names:
            raise StoreError(f"{where}.name: found {one.name!r}, expected a name that no other series has")
        names.add(one.name)
        if len({channel.name for channel in one.channels}) < len(one.channels):
            raise StoreError(f"{where}.channels: two of one name, expected names of their own")
        for channel in one.channels:
            _check_channel(f"{where}.{channel.name}", channel)
            if are_new:
                check_quantity(f"{where}.{channel.name}.unit", channel.unit, channel.quantity)
        _check_lengths(where, one)


def _check_channel(where: str, channel: Channel) -> None:
    check_name(f"{where}.name", channel.name)
    check_name(f"{where}.quantity", channel.quantity)
    values = channel.values
    dtype = values.dtype
    if dtype.kind not in NUMBERS or dtype.itemsize > 8:
        raise StoreError(
            f"{where}.values: samples of {dtype}, expected numbers of at most 8 bytes, as many in each sample"
        )
    if not values.ndim:
        raise StoreError(f"{where}.values: a single number, expected an array of samples")
    if channel.rate_hz is not None:
        check_number(f"{where}.rate_hz", channel.rate_hz)
        if channel.rate_hz <= 0:
            raise StoreError(f"{where}.rate_hz: found {channel.rate_hz}, expected a positive number")
    if channel.time_s is not None:
        _check_time(where, channel.time_s, len(values))
    if channel.unit is not None:
        check_name(f"{where}.unit", channel.unit)


def _check_time(where: str, time_s: np.ndarray[tuple[int, ...], np.dtype[np.float64]], samples: int) -> None:
    if time_s.shape != (samples,):
        raise StoreError(f"{where}.time_s: shape {time_s.shape} for {samples} samples, expected ({samples},)")
    if not np.isfinite(time_s).all():
        raise StoreError(f"{where}.time_s: a time stamp is not finite, expected seconds")


def _check_lengths(where: str, series: Series) -> None:
    """Channels sampled at one rate have one length; those with time stamps are checked by themselves."""
    lengths: dict[float | None, tuple[str, int]] = {}
    for channel in series.channels:
        if channel.time_s is None:
            first, length = lengths.setdefault(channel.rate_hz, (channel.name, len(channel.values)))
            if len(channel.values) != length:
                raise StoreError(
                    f"{where}.{channel.name}.values: {len(channel.values)} samples, "
                    f"expected {length} as in {first!r} of the same rate"
                )
