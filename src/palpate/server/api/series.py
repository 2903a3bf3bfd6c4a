"""Series: the samples of a recording as JSON, CSV or Arrow, and sounds as sound files."""

from __future__ import annotations

import csv
import io
import struct
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from fastapi import APIRouter, Query, Request
from fastapi.responses import Response, StreamingResponse
from numpy.typing import NDArray
from pydantic import Field

from palpate.server.api import plain
from palpate.server.api.answers import answer, finite
from palpate.server.api.downloads import download
from palpate.server.api.models import Page, SeriesInfo, SeriesSamples, Strict
from palpate.server.api.parameters import Place, SeenRecording, StoreOf
from palpate.server.problems import problem
from palpate.store.content import canonical_array
from palpate.store.parts import Head, series_of
from palpate.store.records import Channel, Series
from palpate.store.store import Store

if TYPE_CHECKING:
    import pyarrow

__all__ = ["cell_text", "is_sound", "router"]

router = APIRouter(prefix="/recordings/{key}/series", tags=["series"])
LARGEST_VALUES = 2_000_000
"""Samples as text; more of them are to be had as Arrow."""
SLOWEST_SOUND_HZ = 4_000
CSV, ARROW = "text/csv", "application/vnd.apache.arrow.stream"
Form = Literal["json", "csv", "arrow"]


class Asked(Strict):
    """In which form."""

    form: Form = Field("json", alias="format")


@router.get("", response_model=Page[SeriesInfo])
def list_series(head: SeenRecording) -> Response:
    """All series of a recording, without their samples."""
    return answer({"items": plain.series_infos(head), "next": None})


@router.get("/{position}", response_model=SeriesSamples, responses={200: {"content": {CSV: {}, ARROW: {}}}})
def get_series(store: StoreOf, head: SeenRecording, position: Place, asked: Annotated[Asked, Query()]) -> Response:
    """A series with its samples.

    As CSV and Arrow it has a row for each sample: channel, index, time [s] where it is known, and value; a sample
    of several numbers has a row for each of them.
    """
    series = found_series(store, head, position)
    count = sum(channel.values.size for channel in series.channels)
    if asked.form != "arrow" and count > LARGEST_VALUES:
        raise problem(422, f"format: {count} numbers are too many as text, expected format=arrow")
    return FORMS[asked.form](series)


@router.get("/{position}/channels/{channel}/sound", response_class=Response)
def get_sound(request: Request, store: StoreOf, head: SeenRecording, position: Place, channel: Place) -> Response:
    """A channel that is a sound, as a WAV file of 16 bits; its loudest sample is full scale."""
    series = found_series(store, head, position)
    if channel >= len(series.channels) or not is_sound(series.channels[channel]):
        raise problem(404, f"recording {head.id}: series {position} has no sound at channel {channel}")
    data = wav(series.channels[channel])
    return download(request, data, f"{series.name}.wav", "audio/wav", f"{head.digest}-{position}-{channel}")


def found_series(store: Store, head: Head, position: int) -> Series:
    """A series, or an error of the request."""
    series = series_of(store, head, position)
    if series is None:
        raise problem(404, f"recording {head.id}: has {len(head.series)} series, and none at {position}")
    return series


def is_sound(channel: Channel) -> bool:
    """Whether a channel can be heard: evenly spaced samples, enough of them each second.

    Examples
    --------
    >>> is_sound(Channel("sound", "sound pressure", "Pa", np.zeros(9), rate_hz=44_100.0))
    True
    """
    return channel.rate_hz is not None and channel.rate_hz >= SLOWEST_SOUND_HZ and channel.values.ndim == 1


def wav(channel: Channel) -> bytes:
    """A channel as a WAV file."""
    values = np.nan_to_num(np.asarray(channel.values, dtype=np.float64))
    loudest = float(np.abs(values).max(initial=0.0)) or 1.0
    samples = (values / loudest * 32767).astype("<i2").tobytes()
    rate = round(channel.rate_hz or 0)
    form = struct.pack("<HHIIHH", 1, 1, rate, 2 * rate, 2, 16)
    body = b"WAVEfmt " + struct.pack("<I", len(form)) + form + b"data" + struct.pack("<I", len(samples)) + samples
    return b"RIFF" + struct.pack("<I", len(body)) + body


def _as_json(series: Series) -> Response:
    channels = [{**_channel(one), "values": _values(one), "time_s": _times(one)} for one in series.channels]
    return answer({"name": series.name, "channels": channels})


def _channel(channel: Channel) -> dict[str, object]:
    told = {name: getattr(channel, name) for name in ("name", "quantity", "unit", "rate_hz")}
    return {**told, "timed": channel.time_s is not None, "shape": list(channel.values.shape)}


def _values(channel: Channel) -> object:
    return finite(canonical_array(channel.values).tolist())


def _times(channel: Channel) -> object:
    return None if channel.time_s is None else finite(channel.time_s.tolist())


def seconds(channel: Channel) -> NDArray[np.float64] | None:
    """The time of each sample [s], (n); None where it is not known."""
    if channel.time_s is not None:
        return channel.time_s
    return None if channel.rate_hz is None else np.arange(len(channel.values)) / channel.rate_hz


def _as_csv(series: Series) -> Response:
    return StreamingResponse(_csv_lines(series), media_type=CSV, headers=_attached("csv"))


def _csv_lines(series: Series) -> Iterator[str]:
    yield "channel,unit,index,time_s,value\r\n"
    for channel in series.channels:
        times = seconds(channel)
        flat = channel.values.reshape(len(channel.values), -1) if channel.values.size else np.empty((0, 1))
        lines = io.StringIO()
        writer = csv.writer(lines)
        for index, sample in enumerate(flat.tolist()):
            time_s = "" if times is None else repr(float(times[index]))
            writer.writerows(
                (cell_text(channel.name), cell_text(channel.unit or ""), index, time_s, value) for value in sample
            )
        yield lines.getvalue()


def cell_text(text: str) -> str:
    """Text that no spreadsheet takes for a formula."""
    return f"'{text}" if text[:1] in tuple("=+-@\t\r") else text


def _as_arrow(series: Series) -> Response:
    import pyarrow as pa

    parts = [_arrow_table(channel) for channel in series.channels]
    sink = pa.BufferOutputStream()
    table = pa.concat_tables(parts) if parts else _arrow_schema().empty_table()
    with pa.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table)
    data = sink.getvalue().to_pybytes()
    return Response(data, 200, _attached("arrows"), ARROW)


def _arrow_schema() -> pyarrow.Schema:
    import pyarrow as pa

    texts = [pa.field(name, pa.string()) for name in ("channel", "unit")]
    return pa.schema([*texts, ("index", pa.int64()), ("time_s", pa.float64()), ("value", pa.float64())])


def _arrow_table(channel: Channel) -> pyarrow.Table:
    import pyarrow as pa

    count = len(channel.values)
    each = channel.values.size // count if count else 1
    times = seconds(channel)
    size = count * each
    columns = [
        pa.array([channel.name] * size, pa.string()),
        pa.array([channel.unit] * size, pa.string()),
        pa.array(np.repeat(np.arange(count), each)),
        pa.nulls(size, pa.float64()) if times is None else pa.array(np.repeat(np.asarray(times, np.float64), each)),
        pa.array(np.asarray(channel.values, dtype=np.float64).ravel()),
    ]
    return pa.Table.from_arrays(columns, schema=_arrow_schema())


def _attached(ending: str) -> dict[str, str]:
    return {"Content-Disposition": f'attachment; filename="series.{ending}"'}


FORMS: Mapping[str, Callable[[Series], Response]] = {"json": _as_json, "csv": _as_csv, "arrow": _as_arrow}
