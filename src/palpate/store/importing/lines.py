"""A recording as one line of JSON: the form of batches for programs that make no packages.

The fields are those of `palpate.store.records.Recording`, as a package has them; ``entries``, ``thing`` and ``setup``
are objects, a setup one of devices: ``{"gripper": {"name": ...}, "other": [{"name": ...}]}``. ``series`` is a list of
``{"name", "channels"}``. A channel has ``name``, ``quantity``, ``unit``, and ``rate_hz`` or ``time_s``; its ``values``
are nested lists, null where a sample is missing, or ``{"dtype", "shape", "base64"}``. ``files`` are
``{"name", "media_type", "base64"}``.
"""

from __future__ import annotations

import base64
import binascii
import json
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.store.content import canonical_array
from palpate.store.errors import StoreError
from palpate.store.importing.line_fields import decoded, named
from palpate.store.importing.plain import FIELDS, encode
from palpate.store.records import Channel, FileItem, Recording, Series

__all__ = ["line_of", "recording_of"]

NEEDED = ("recorded_at", "action", "thing")
SIGNALS = ("series", "files", "log")
KINDS = "biuf"
"""Of numbers: truth values, whole numbers and fractions."""


def line_of(recording: Recording) -> str:
    """Write a recording as a line; bytes of files that are paths are read.

    Examples
    --------
    >>> from datetime import UTC, datetime
    >>> from palpate.store.records import ThingRef
    >>> one = Recording(datetime(2024, 5, 1, tzinfo=UTC), "weighing", ThingRef("ycb", "025_mug"))
    >>> recording_of(line_of(one).encode()) == one
    True
    """
    plain = encode({name: getattr(recording, name) for name in FIELDS})
    series = [
        {"name": one.name, "channels": [_channel_plain(each) for each in one.channels]} for one in recording.series
    ]
    files = [{"name": one.name, "media_type": one.media_type, "base64": _text(_bytes(one))} for one in recording.files]
    return json.dumps({**plain, "series": series, "files": files, "log": recording.log})


def recording_of(line: bytes) -> Recording:
    """Read a line that anybody may have sent.

    Raises
    ------
    StoreError
        Naming the field that is missing, unknown, or not what stands there.
    """
    try:
        plain = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise StoreError(f"line: is no JSON ({error})") from None
    if not isinstance(plain, dict):
        raise StoreError(f"line: is a {type(plain).__name__}, expected an object with the fields of a recording")
    missing = [name for name in NEEDED if name not in plain]
    if missing:
        raise StoreError(f"{missing[0]}: is missing, expected it in each line")
    signals = {name: plain.pop(name) for name in SIGNALS if name in plain}
    fields = decoded(plain)
    series = tuple(_series(f"series[{n}]", one) for n, one in enumerate(_list("series", signals.get("series", []))))
    files = tuple(_file(f"files[{n}]", one) for n, one in enumerate(_list("files", signals.get("files", []))))
    log = signals.get("log", "")
    if not isinstance(log, str):
        raise StoreError(f"log: is a {type(log).__name__}, expected text")
    return Recording(**fields, series=series, files=files, log=log)


def _channel_plain(channel: Channel) -> dict[str, Any]:
    told = {name: getattr(channel, name) for name in ("name", "quantity", "unit", "rate_hz")}
    times = None if channel.time_s is None else channel.time_s.tolist()
    array = canonical_array(channel.values)
    values = {"dtype": array.dtype.str, "shape": list(array.shape), "base64": _text(array.tobytes())}
    return {**told, "time_s": times, "values": values}


def _series(where: str, plain: Any) -> Series:
    fields = named(where, plain, ("name", "channels"), ())
    channels = _list(f"{where}.channels", fields["channels"])
    return Series(fields["name"], tuple(_channel(f"{where}.channels[{n}]", one) for n, one in enumerate(channels)))


def _channel(where: str, plain: Any) -> Channel:
    fields = named(where, plain, ("name", "quantity", "values"), ("unit", "rate_hz", "time_s"))
    times = fields.get("time_s")
    rate = fields.get("rate_hz")
    if rate is not None and (isinstance(rate, bool) or not isinstance(rate, int | float)):
        raise StoreError(f"{where}.rate_hz: found {rate!r}, expected a number")
    return Channel(
        fields["name"],
        fields["quantity"],
        fields.get("unit"),
        _array(f"{where}.values", fields["values"]),
        rate,
        None if times is None else _numbers(f"{where}.time_s", times),
    )


def _array(where: str, plain: Any) -> NDArray[Any]:
    if isinstance(plain, list):
        return _numbers(where, plain)
    fields = named(where, plain, ("dtype", "shape", "base64"), ())
    shape = fields["shape"]
    try:
        dtype = np.dtype(fields["dtype"])
    except (TypeError, ValueError):
        dtype = np.dtype(object)
    if dtype.kind not in KINDS:
        raise StoreError(f"{where}.dtype: found {str(fields['dtype'])[:40]!r}, expected that of numbers, such as '<f4'")
    if not (isinstance(shape, list) and shape and all(type(n) is int and 0 <= n < 1 << 40 for n in shape)):
        raise StoreError(f"{where}.shape: found {str(shape)[:40]}, expected a list of lengths")
    data = _data(f"{where}.base64", fields["base64"])
    if prod(shape) * dtype.itemsize != len(data):
        raise StoreError(f"{where}: {len(data)} bytes, expected {prod(shape) * dtype.itemsize} as its shape says")
    return np.frombuffer(data, dtype).reshape(shape)


def _numbers(where: str, plain: Any) -> NDArray[np.float64]:
    try:
        return np.array(plain, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise StoreError(f"{where}: is no list of numbers, or of lists of one length") from None


def _file(where: str, plain: Any) -> FileItem:
    fields = named(where, plain, ("name", "media_type", "base64"), ())
    return FileItem(fields["name"], fields["media_type"], _data(f"{where}.base64", fields["base64"]))


def _data(where: str, text: Any) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (TypeError, ValueError, binascii.Error):
        raise StoreError(f"{where}: is no base64") from None


def _list(where: str, plain: Any) -> list[Any]:
    if not isinstance(plain, list):
        raise StoreError(f"{where}: is a {type(plain).__name__}, expected a list")
    return plain


def _bytes(item: FileItem) -> bytes:
    return item.data if isinstance(item.data, bytes) else item.data.read_bytes()


def _text(data: bytes) -> str:
    return base64.b64encode(data).decode()
