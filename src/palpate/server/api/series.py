"""Series: the samples of a recording as JSON, CSV or Arrow, and sounds as sound files."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response, StreamingResponse
from pydantic import Field

from palpate.server.api import plain
from palpate.server.api.answers import answer, finite
from palpate.server.api.arrows import ARROW, arrow_pieces
from palpate.server.api.downloads import download
from palpate.server.api.models import Page, SeriesInfo, SeriesSamples, Strict
from palpate.server.api.parameters import Place, SeenRecording, StoreOf
from palpate.server.api.sounds import SoundFile, is_sound
from palpate.server.api.stretches import stretches
from palpate.server.memory import Held, Memory
from palpate.server.problems import problem
from palpate.store.content import canonical_array
from palpate.store.parts import Head, series_of
from palpate.store.records import Channel, Series
from palpate.store.store import Store

__all__ = ["cell_text", "found_series", "router"]

router = APIRouter(prefix="/recordings/{key}/series", tags=["series"])
LARGEST_VALUES = 2_000_000
"""Samples as text; more of them are to be had as Arrow."""
LARGEST_READ_BYTES = 128 << 20
"""Of a series, which is unpacked whole before any of it is sent; more are to be had in the recording's package."""
UNPACKED = 3
"""While a series is unpacked it is there so many times: compressed, as bytes, and as numbers."""
TEXT_BYTES = 100
"""Of a number that is written as JSON."""
CSV = "text/csv"
Form = Literal["json", "csv", "arrow"]


class Asked(Strict):
    """In which form."""

    form: Form = Field("json", alias="format")


@router.get("", response_model=Page[SeriesInfo])
def list_series(head: SeenRecording) -> Response:
    """All series of a recording, without their samples."""
    return answer({"items": plain.series_infos(head), "next": None})


@router.get("/{position}", response_model=SeriesSamples, responses={200: {"content": {CSV: {}, ARROW: {}}}})
def get_series(
    store: StoreOf, head: SeenRecording, memory: Memory, position: Place, asked: Annotated[Asked, Query()]
) -> Response:
    """A series with its samples.

    As CSV and Arrow it has a row for each sample: channel, index, time [s] where it is known, and value; a sample
    of several numbers has a row for each of them. Whole numbers are exact; in Arrow those that a double would round are
    in a column ``whole`` where other channels of the series hold others.
    """
    info = head.series[position] if position < len(head.series) else None
    if asked.form != "arrow" and info is not None and info.numbers > LARGEST_VALUES:
        raise problem(422, f"format: {info.numbers} numbers are too many as text, expected format=arrow")
    if asked.form == "json" and info is not None:
        memory.take(TEXT_BYTES * info.numbers)
    return FORMS[asked.form](found_series(store, head, memory, position))


@router.get("/{position}/channels/{channel}/sound", response_class=Response)
def get_sound(
    request: Request, store: StoreOf, head: SeenRecording, memory: Memory, position: Place, channel: Place
) -> Response:
    """A channel that is a sound, as a WAV file of 16 bits; its loudest sample is full scale."""
    series = found_series(store, head, memory, position)
    if channel >= len(series.channels) or not is_sound(series.channels[channel]):
        raise problem(404, f"recording {head.id}: series {position} has no sound at channel {channel}")
    sound = SoundFile(series.channels[channel])
    return download(request, sound, f"{series.name}.wav", "audio/wav", f"{head.digest}-{position}-{channel}")


def found_series(store: Store, head: Head, memory: Held, position: int) -> Series:
    """A series, or an error of the request where there is none, it is too large, or others take the memory for it."""
    size_bytes = head.series[position].size_bytes if position < len(head.series) else 0
    if size_bytes > LARGEST_READ_BYTES:
        most = f"expected {LARGEST_READ_BYTES} at most; all of it is in the recording's package"
        raise problem(422, f"recording {head.id}: series {position} has {size_bytes} bytes, {most}")
    memory.take(UNPACKED * size_bytes)
    series = series_of(store, head, position)
    if series is None:
        raise problem(404, f"recording {head.id}: has {len(head.series)} series, and none at {position}")
    return series


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


def _as_csv(series: Series) -> Response:
    return StreamingResponse(_csv_lines(series), media_type=CSV, headers=_attached("csv"))


def _csv_lines(series: Series) -> Iterator[str]:
    yield "channel,unit,index,time_s,value\r\n"
    for channel in series.channels:
        for start, stop, times in stretches(channel):
            lines = io.StringIO()
            writer = csv.writer(lines)
            told = cell_text(channel.name), cell_text(channel.unit or "")
            for index, sample in enumerate(channel.values[start:stop].reshape(stop - start, -1).tolist()):
                time_s = "" if times is None else repr(float(times[index]))
                writer.writerows((*told, start + index, time_s, value) for value in sample)
            yield lines.getvalue()


def cell_text(text: str) -> str:
    """Text that no spreadsheet takes for a formula."""
    return f"'{text}" if text[:1] in tuple("=+-@\t\r") else text


def _as_arrow(series: Series) -> Response:
    return StreamingResponse(arrow_pieces(series), media_type=ARROW, headers=_attached("arrows"))


def _attached(ending: str) -> dict[str, str]:
    return {"Content-Disposition": f'attachment; filename="series.{ending}"'}


FORMS: Mapping[str, Callable[[Series], Response]] = {"json": _as_json, "csv": _as_csv, "arrow": _as_arrow}
