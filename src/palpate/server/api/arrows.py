"""A series as an Arrow stream, a batch after the other."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate.server.api.stretches import stretches
from palpate.store.content import canonical_array
from palpate.store.records import Channel, Series

if TYPE_CHECKING:
    import pyarrow

__all__ = ["ARROW", "arrow_pieces"]

ARROW = "application/vnd.apache.arrow.stream"
WHOLE = "whole"
EXACT = 1 << 53
"""Up to here each whole number is a double."""


def arrow_pieces(series: Series) -> Iterator[bytes]:
    """The bytes of the stream: first its schema, then each batch as it is made.

    Names and units are dictionaries, so that no row holds their text. Where all channels hold whole numbers, so does
    the column ``value``; where only some do, and one is beyond what a double holds, these are in ``whole`` too.
    """
    import pyarrow as pa

    sink, schema = io.BytesIO(), _schema(series)
    with pa.ipc.new_stream(sink, schema) as writer:
        yield _taken(sink)
        for batch in _batches(series, schema):
            writer.write_batch(batch)
            yield _taken(sink)
    yield _taken(sink)


def _taken(sink: io.BytesIO) -> bytes:
    """What was written since the last time."""
    found = sink.getvalue()
    sink.seek(0)
    sink.truncate()
    return found


def _schema(series: Series) -> pyarrow.Schema:
    import pyarrow as pa

    text = pa.dictionary(pa.int32(), pa.string())
    whole = [channel.values for channel in series.channels if _is_whole(channel)]
    ends = [int(end) for values in whole if values.size for end in (values.min(), values.max())]
    are_all = bool(whole) and len(whole) == len(series.channels)
    value = _whole_type(ends) if are_all else pa.float64()
    beside = [] if are_all or max(map(abs, ends), default=0) <= EXACT else [(WHOLE, _whole_type(ends))]
    numbers = [("index", pa.int64()), ("time_s", pa.float64()), ("value", value)]
    return pa.schema([("channel", text), ("unit", text), *numbers, *beside])


def _is_whole(channel: Channel) -> bool:
    return channel.values.dtype.kind in "biu"


def _whole_type(ends: Sequence[int]) -> pyarrow.DataType:
    """A type that holds the least and the greatest of whole numbers."""
    import pyarrow as pa

    if max(ends, default=0) < 1 << 63:
        return pa.int64()
    return pa.uint64() if min(ends) >= 0 else pa.decimal128(20)


def _batches(series: Series, schema: pyarrow.Schema) -> Iterator[pyarrow.RecordBatch]:
    import pyarrow as pa

    # one dictionary for all batches: not every reader takes another one in the middle
    names = pa.array([channel.name for channel in series.channels], pa.string())
    told = list(dict.fromkeys(channel.unit for channel in series.channels if channel.unit is not None))
    units = pa.array(told, pa.string())
    for place, channel in enumerate(series.channels):
        unit = None if channel.unit is None else told.index(channel.unit)
        for start, stop, times in stretches(channel):
            values = canonical_array(channel.values[start:stop]).reshape(stop - start, -1)
            size, each = values.size, values.shape[1]
            time_s = pa.nulls(size, pa.float64()) if times is None else pa.array(np.repeat(times, each))
            index = pa.array(np.repeat(np.arange(start, stop), each))
            named = [_repeated(place, names, size), _repeated(unit, units, size)]
            numbers = _numbers(values.ravel(), schema, is_whole=_is_whole(channel))
            yield pa.RecordBatch.from_arrays([*named, index, time_s, *numbers], schema=schema)


def _numbers(values: NDArray[Any], schema: pyarrow.Schema, *, is_whole: bool) -> Iterator[pyarrow.Array]:
    """The column of values, and that of whole numbers where there is one."""
    import pyarrow as pa

    # what is true or false is a number here, which pyarrow does not make of it for each type
    plain = values.astype(np.int8) if values.dtype.kind == "b" else values
    given, value = pa.array(plain), schema.field("value").type
    # some whole numbers are rounded to doubles, and stand exactly beside these
    yield pa.array(values.astype(np.float64)) if value == pa.float64() else given.cast(value)
    if WHOLE in schema.names:
        whole = schema.field(WHOLE).type
        yield given.cast(whole) if is_whole else pa.nulls(len(values), whole)


def _repeated(place: int | None, texts: pyarrow.Array, size: int) -> pyarrow.Array:
    import pyarrow as pa

    places = pa.nulls(size, pa.int32()) if place is None else pa.array(np.full(size, place, dtype=np.int32))
    return pa.DictionaryArray.from_arrays(places, texts)
