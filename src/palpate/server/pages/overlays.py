"""Recordings of one object that are laid over each other: which there are, which are chosen, and the plot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated
from urllib.parse import urlencode
from uuid import UUID

from fastapi import APIRouter, Query
from fastapi.responses import Response
from pydantic import Field

from palpate.server.api.parameters import StoreOf
from palpate.server.memory import Held, Memory
from palpate.server.pages.allowance import Allowance
from palpate.server.pages.others import in_words
from palpate.server.pages.shown import Dark, Shown, figure, shown
from palpate.server.pages.signals import MOST_SERIES, found_squeeze
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.drawing import COLOURS
from palpate.server.plots.overlays import Laid, Overlay, overlay
from palpate.server.plots.plot import Plot
from palpate.server.plots.squeezes import FoundSqueeze, may_be_squeeze
from palpate.server.security.who import Who
from palpate.store.parts import Head, head_of, series_of
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_results import Result

__all__ = ["Choice", "Chosen", "choices_of", "laid_over", "router"]

router = APIRouter(prefix="/compare")
OF_A_DEVICE = 6
"""Recordings of one device among which to choose."""
Chosen = Annotated[list[UUID], Query(max_length=COLOURS)]
Colours = Annotated[tuple[Annotated[int, Field(ge=0, lt=COLOURS)], ...], Query(max_length=COLOURS)]


@dataclass(frozen=True)
class Choice:
    """A recording that may be chosen; `colour` is that of its device, None where it is not drawn.

    Of very many that are `ticked` not all are drawn.
    """

    recording: UUID
    name: str
    value: str
    colour: int | None
    ticked: bool


def choices_of(results: Sequence[Result], chosen: Sequence[UUID], colours: Mapping[str, int]) -> list[Choice]:
    """The last recordings of each device; unless told which, the last one of each is chosen.

    `colours` has that of each device.
    """
    last: dict[UUID, Result] = {}
    for one in reversed(results):
        last.setdefault(one.recording, one)
    counts: Counter[str] = Counter()
    shown, first = [], []
    for one in last.values():
        counts[one.measured_by] += 1
        if counts[one.measured_by] == 1:
            first.append(one.recording)
        if counts[one.measured_by] <= OF_A_DEVICE or one.recording in chosen:
            shown.append(one)
    there = [one.recording for one in shown]
    wanted = [key for key in dict.fromkeys(chosen) if key in there] or first[:COLOURS]
    drawn = wanted[:COLOURS]
    found = [
        Choice(
            recording=one.recording,
            name=_name(one),
            value=in_words(one),
            colour=colours[one.measured_by] if one.recording in drawn else None,
            ticked=one.recording in wanted,
        )
        for one in shown
    ]
    return sorted(found, key=lambda one: one.name)


def _name(one: Result) -> str:
    return f"{one.measured_by}, {one.recorded_at:%Y-%m-%d %H:%M}"


def laid_over(
    store: Store, viewer: Viewer, memory: Held, colours: Mapping[UUID, int]
) -> tuple[Shown | None, Overlay, list[Laid]]:
    """The plot of recordings, as far as they are seen, each in its colour; and those that are too large to be read."""
    laid = list(_laid(store, viewer, Allowance(memory=memory), list(colours), list(colours.values())))
    found = overlay([one for one in laid if one.too_large is None])
    asked = [pair for key, colour in colours.items() for pair in (("recording", str(key)), ("colour", str(colour)))]
    address = f"/compare/curves.json?{urlencode(asked)}"
    return shown(found.plot, address), found, [one for one in laid if one.too_large is not None]


@router.get("/curves.json")
def curves(
    store: StoreOf, who: Who, memory: Memory, recording: Chosen, colour: Colours = (), dark: Dark = False
) -> Response:
    """The figure of recordings that are laid over each other, each in its colour; without colours, one each."""
    colours = colour or range(len(recording))
    laid = _laid(store, who.viewer, Allowance(memory=memory), recording, colours)
    return figure(overlay([one for one in laid if one.too_large is None]).plot, dark=dark)


def _laid(
    store: Store, viewer: Viewer, left: Allowance, recordings: Sequence[UUID], colours: Sequence[int]
) -> Iterator[Laid]:
    for place, key in enumerate(recordings):
        head = head_of(store, viewer, key)
        if head is None:
            continue
        squeeze, plot, is_whole = _first(store, head, left)
        devices = head.setup.devices
        device = head.setup.gripper or (devices[0] if devices else None)
        name = f"{device.name if device else 'nothing that is named'}, {head.recorded_at:%Y-%m-%d %H:%M}"
        too_large = None if is_whole or squeeze or plot else head.id
        yield Laid(name, colours[place % len(colours)], squeeze, plot, too_large)


def _first(store: Store, head: Head, left: Allowance) -> tuple[FoundSqueeze | None, Plot | None, bool]:
    """The first squeeze of a recording, or else its first channel that is a curve; whether all could be read for it."""
    places = range(len(head.series[:MOST_SERIES]))
    squeezes = [place for place in places if may_be_squeeze(one["unit"] for one in head.series[place].channels)]
    plot, is_whole = None, len(places) == len(head.series)
    for place in (*squeezes, *(place for place in places if place not in squeezes)):
        if plot is not None and place not in squeezes:
            break
        series = series_of(store, head, place) if left.reads(head.series[place].numbers) else None
        if series is None:
            is_whole = False
            continue
        found = found_squeeze(head, series, left)
        if found is not None:
            return found, None, is_whole
        plot = plot or next(filter(None, map(channel_plot, series.channels)), None)
    return None, plot, is_whole
