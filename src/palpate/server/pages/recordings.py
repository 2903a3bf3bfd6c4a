"""Recordings: a list of them, and a page for each with its signals."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from palpate.server.api.parameters import Place, SeenRecording, StoreOf
from palpate.server.api.queries import RecordingQuery
from palpate.server.api.sounds import is_sound
from palpate.server.memory import Memory
from palpate.server.pages.allowance import MOST_NUMBERS, Allowance
from palpate.server.pages.citing import citation
from palpate.server.pages.saved import saved
from palpate.server.pages.sharing import form_values
from palpate.server.pages.shown import Dark, figure
from palpate.server.pages.signals import (
    MOST_FILES,
    MOST_SERIES,
    drawn_series,
    found_squeeze,
    shown_files,
    shown_signals,
    sound_of_file,
)
from palpate.server.pages.templates import page, with_query
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.spectrogram import spectrogram
from palpate.server.plots.squeezes import squeeze_plot
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store import schema
from palpate.store.listing import list_recordings
from palpate.store.parts import log_of
from palpate.store.store import Store
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_setups import seen_choices
from palpate.store.visible_things import ThingFilter, list_visible_things

__all__ = ["router"]

router = APIRouter(prefix="/recordings")
LONGEST_LOG = 20_000
OFFERED = 24
"""Objects among which to choose."""


@router.get("")
def rows(request: Request, store: StoreOf, who: Who, query: Annotated[RecordingQuery, Query()]) -> Response:
    """A list of recordings, filtered and sorted; where no object is called so, of the one that is called about so."""
    wanted, sort = query.filter(who.viewer), query.sorting()
    found = list_recordings(store, wanted, sort, limit=query.limit, cursor=query.cursor)
    alike = [] if found.rows or query.object is None else _called_alike(store, who.viewer, query.object)
    if len(alike) == 1:
        return RedirectResponse(with_query(request.url.path, request.query_params, object=alike[0]), 303)
    return page(
        request,
        "recordings.html",
        rows=found.rows,
        cursor=found.cursor,
        asked=query,
        choices=seen_choices(store, who.viewer),
        alike=alike[:OFFERED],
        is_more=len(alike) > OFFERED,
    )


def _called_alike(store: Store, viewer: Viewer, name: str) -> list[str]:
    """Objects that have each word of a name in one of theirs, by their paths; none where one is called exactly so."""
    if list_recordings(store, VisibleFilter(thing=name, viewer=viewer), limit=1).rows:
        return []
    found = list_visible_things(store, viewer, ThingFilter(text=name.replace("/", " ")), limit=OFFERED + 1).rows
    exact = {spelt for one in found for spelt in (one.path, one.ref.id, one.ref.common_name, *one.ref.aliases)}
    return [] if name in exact else [one.path for one in found]


@router.get("/{key}")
def one(request: Request, store: StoreOf, who: Who, head: SeenRecording, memory: Memory) -> HTMLResponse:
    """A recording with its signals, files, setup, poses, results and log."""
    log, left = log_of(store, head), Allowance(memory=memory)
    return page(
        request,
        "recording.html",
        head=head,
        plain=head.document,
        saved=saved(request),
        sharing=form_values(store, who, schema.recordings, head.id),
        signals=list(shown_signals(store, head, left)),
        series_left_out=len(head.series[MOST_SERIES:]),
        most_numbers=MOST_NUMBERS,
        files=shown_files(store, head, left),
        files_left_out=len(head.files[MOST_FILES:]),
        citation=citation(head, str(request.base_url).rstrip("/")),
        log=log[:LONGEST_LOG],
        log_is_longer=len(log) > LONGEST_LOG,
    )


@router.get("/{key}/series/{position}/squeeze.json")
def squeeze(store: StoreOf, head: SeenRecording, memory: Memory, position: Place, dark: Dark = False) -> Response:
    """The figure of a squeeze."""
    found = found_squeeze(head, drawn_series(store, head, memory, position), Allowance())
    return figure(None if found is None else squeeze_plot(found), dark=dark)


@router.get("/{key}/series/{position}/channels/{channel}/plot.json")
def curve(
    store: StoreOf, head: SeenRecording, memory: Memory, position: Place, channel: Place, dark: Dark = False
) -> Response:
    """The figure of a channel over time."""
    channels = drawn_series(store, head, memory, position).channels
    return figure(channel_plot(channels[channel]) if channel < len(channels) else None, dark=dark)


@router.get("/{key}/series/{position}/channels/{channel}/spectrogram.png")
def picture(store: StoreOf, head: SeenRecording, memory: Memory, position: Place, channel: Place) -> Response:
    """How loud a sound is at each pitch, over time."""
    series = drawn_series(store, head, memory, position)
    if channel >= len(series.channels) or not is_sound(series.channels[channel]):
        raise problem(404, f"recording {head.id}: series {position} has no sound at channel {channel}")
    return Response(spectrogram(series.channels[channel]), media_type="image/png")


@router.get("/{key}/files/{place}/plot.json")
def curve_of_file(store: StoreOf, head: SeenRecording, memory: Memory, place: Place, dark: Dark = False) -> Response:
    """The figure of a sound that was recorded as a file."""
    sound = sound_of_file(store, head, memory, place)
    return figure(None if sound is None else channel_plot(sound), dark=dark)


@router.get("/{key}/files/{place}/spectrogram.png")
def picture_of_file(store: StoreOf, head: SeenRecording, memory: Memory, place: Place) -> Response:
    """How loud a sound that was recorded as a file is at each pitch, over time."""
    sound = sound_of_file(store, head, memory, place)
    if sound is None:
        raise problem(404, f"recording {head.id}: there is no sound in file {place}")
    return Response(spectrogram(sound), media_type="image/png")
