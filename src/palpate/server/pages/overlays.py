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
from palpate.server.pages.others import in_words
from palpate.server.pages.shown import Dark, Shown, figure, shown
from palpate.server.pages.signals import LARGEST_PLOTTED, found_squeeze
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.drawing import COLOURS
from palpate.server.plots.overlays import Laid, Overlay, overlay
from palpate.server.security.who import Who
from palpate.store.parts import Head, head_of, series_of
from palpate.store.records import Series
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


def laid_over(store: Store, viewer: Viewer, colours: Mapping[UUID, int]) -> tuple[Shown | None, Overlay]:
    """The plot of recordings, as far as they are seen, each in its colour."""
    found = overlay(list(_laid(store, viewer, list(colours), list(colours.values()))))
    asked = [pair for key, colour in colours.items() for pair in (("recording", str(key)), ("colour", str(colour)))]
    address = f"/compare/curves.json?{urlencode(asked)}"
    return shown(found.plot, address), found


@router.get("/curves.json")
def curves(store: StoreOf, who: Who, recording: Chosen, colour: Colours = (), dark: Dark = False) -> Response:
    """The figure of recordings that are laid over each other, each in its colour; without colours, one each."""
    colours = colour or range(len(recording))
    return figure(overlay(list(_laid(store, who.viewer, recording, colours))).plot, dark=dark)


def _laid(store: Store, viewer: Viewer, recordings: Sequence[UUID], colours: Sequence[int]) -> Iterator[Laid]:
    for place, key in enumerate(recordings):
        colour = colours[place % len(colours)]
        head = head_of(store, viewer, key)
        if head is None:
            continue
        series = list(_small_series(store, head))
        squeezes = (found_squeeze(head, one) for one in series)
        plots = (channel_plot(channel) for one in series for channel in one.channels)
        devices = head.setup.devices
        device = head.setup.gripper or (devices[0] if devices else None)
        name = f"{device.name if device else 'nothing that is named'}, {head.recorded_at:%Y-%m-%d %H:%M}"
        yield Laid(name, colour, next(filter(None, squeezes), None), next(filter(None, plots), None))


def _small_series(store: Store, head: Head) -> Iterator[Series]:
    for position, info in enumerate(head.series):
        if sum(channel["count"] for channel in info.channels) <= LARGEST_PLOTTED // COLOURS:
            series = series_of(store, head, position)
            if series is not None:
                yield series
