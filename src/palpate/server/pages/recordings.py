"""Recordings: a list of them, and a page for each with its signals."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response
from markupsafe import Markup

from palpate.server.api.downloads import NO_TYPE, safe_type
from palpate.server.api.parameters import Place, SeenRecording, StoreOf
from palpate.server.api.queries import RecordingQuery
from palpate.server.api.series import found_series, is_sound
from palpate.server.pages.sharing import form_values
from palpate.server.pages.templates import page
from palpate.server.plots.curves import channel_plot, squeeze_of, squeeze_plot
from palpate.server.plots.spectrogram import spectrogram
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store import schema
from palpate.store.listing import list_recordings
from palpate.store.parts import Head, file_of, log_of, series_of
from palpate.store.records import Series
from palpate.store.store import Store

__all__ = ["router"]

router = APIRouter(prefix="/recordings")
MOST_PLOTS = 12
"""Channels of a series that are drawn."""
LARGEST_PLOTTED = 20_000_000
"""Samples of a series that are read to be drawn."""
LONGEST_LOG = 20_000
LARGEST_SHOWN = 50 << 20


@router.get("")
def rows(request: Request, store: StoreOf, who: Who, query: Annotated[RecordingQuery, Query()]) -> HTMLResponse:
    """A list of recordings, filtered and sorted."""
    wanted, sort = query.filter(who.viewer), query.sorting()
    found = list_recordings(store, wanted, sort, limit=query.limit, cursor=query.cursor)
    return page(request, "recordings.html", rows=found.rows, cursor=found.cursor, asked=query)


@dataclass(frozen=True)
class Signals:
    """What a page shows of a series."""

    name: str
    position: int
    squeeze: Markup | None
    plots: tuple[tuple[str, Markup], ...]
    sounds: tuple[int, ...]
    left_out: int


@router.get("/{key}")
def one(request: Request, store: StoreOf, who: Who, head: SeenRecording) -> HTMLResponse:
    """A recording with its signals, files, setup, poses, results and log."""
    log = log_of(store, head)
    return page(
        request,
        "recording.html",
        head=head,
        plain=head.document,
        sharing=form_values(store, who, schema.recordings, head.id),
        signals=list(_signals(store, head)),
        files=[_shown(store, head, place) for place in range(len(head.files))],
        log=log[:LONGEST_LOG],
        log_is_longer=len(log) > LONGEST_LOG,
    )


@router.get("/{key}/series/{position}/channels/{channel}/spectrogram.png")
def picture(store: StoreOf, head: SeenRecording, position: Place, channel: Place) -> Response:
    """How loud a sound is at each pitch, over time."""
    series = found_series(store, head, position)
    if channel >= len(series.channels) or not is_sound(series.channels[channel]):
        raise problem(404, f"recording {head.id}: series {position} has no sound at channel {channel}")
    return Response(spectrogram(series.channels[channel]), media_type="image/png")


def _signals(store: Store, head: Head) -> Iterator[Signals]:
    for position, info in enumerate(head.series):
        if sum(channel["count"] for channel in info.channels) > LARGEST_PLOTTED:
            yield Signals(info.name, position, None, (), (), len(info.channels))
            continue
        series = series_of(store, head, position)
        if series is not None:
            yield _drawn(series, position)


def _drawn(series: Series, position: int) -> Signals:
    squeeze = squeeze_of(series)
    drawn = ((channel.name, channel_plot(channel)) for channel in series.channels[:MOST_PLOTS])
    plots = tuple((name, plot) for name, plot in drawn if plot is not None)
    sounds = tuple(place for place, channel in enumerate(series.channels) if is_sound(channel))
    left_out = len(series.channels) - len(plots)
    return Signals(series.name, position, None if squeeze is None else squeeze_plot(squeeze), plots, sounds, left_out)


def _shown(store: Store, head: Head, place: int) -> dict[str, Any]:
    """A file, and whether it can be shown as a picture or heard."""
    item = head.files[place]
    kind = item.media_type.partition("/")[0]
    data = file_of(store, head, place) if kind in ("image", "audio") else None
    shown = data is not None and len(data) <= LARGEST_SHOWN and safe_type(item.media_type, data) != NO_TYPE
    return {"item": item, "url": f"/api/v1/recordings/{head.id}/files/{place}", "kind": kind if shown else "other"}
