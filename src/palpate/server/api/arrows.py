"""A series as an Arrow stream, a batch after the other."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from palpate.server.api.stretches import stretches
from palpate.store.records import Series

if TYPE_CHECKING:
    import pyarrow

__all__ = ["ARROW", "arrow_pieces"]

ARROW = "application/vnd.apache.arrow.stream"


def arrow_pieces(series: Series) -> Iterator[bytes]:
    """The bytes of the stream: first its schema, then each batch as it is made.

    Names and units are dictionaries, so that no row holds their text.
    """
    import pyarrow as pa

    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, _schema()) as writer:
        yield _taken(sink)
        for batch in _batches(series):
            writer.write_batch(batch)
            yield _taken(sink)
    yield _taken(sink)


def _taken(sink: io.BytesIO) -> bytes:
    """What was written since the last time."""
    found = sink.getvalue()
    sink.seek(0)
    sink.truncate()
    return found


def _schema() -> pyarrow.Schema:
    import pyarrow as pa

    text = pa.dictionary(pa.int32(), pa.string())
    numbers = [("index", pa.int64()), ("time_s", pa.float64()), ("value", pa.float64())]
    return pa.schema([("channel", text), ("unit", text), *numbers])


def _batches(series: Series) -> Iterator[pyarrow.RecordBatch]:
    import pyarrow as pa

    # one dictionary for all batches: not every reader takes another one in the middle
    names = pa.array([channel.name for channel in series.channels], pa.string())
    told = list(dict.fromkeys(channel.unit for channel in series.channels if channel.unit is not None))
    units = pa.array(told, pa.string())
    for place, channel in enumerate(series.channels):
        unit = None if channel.unit is None else told.index(channel.unit)
        for start, stop, times in stretches(channel):
            values = np.asarray(channel.values[start:stop], dtype=np.float64).reshape(stop - start, -1)
            size, each = values.size, values.shape[1]
            time_s = pa.nulls(size, pa.float64()) if times is None else pa.array(np.repeat(times, each))
            index = pa.array(np.repeat(np.arange(start, stop), each))
            named = [_repeated(place, names, size), _repeated(unit, units, size)]
            yield pa.RecordBatch.from_arrays([*named, index, time_s, pa.array(values.ravel())], schema=_schema())


def _repeated(place: int | None, texts: pyarrow.Array, size: int) -> pyarrow.Array:
    import pyarrow as pa

    places = pa.nulls(size, pa.int32()) if place is None else pa.array(np.full(size, place, dtype=np.int32))
    return pa.DictionaryArray.from_arrays(places, texts)
