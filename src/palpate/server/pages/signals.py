"""What a recording's page shows of its signals: curves, squeezes and sounds, of series and of files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from palpate.server.api.downloads import BEGINNING_BYTES, NO_TYPE, safe_type
from palpate.server.api.series import found_series
from palpate.server.api.sounds import is_sound
from palpate.server.memory import Held
from palpate.server.pages.allowance import MOST_FITTED, MOST_NUMBERS, Allowance
from palpate.server.pages.shown import Shown, shown
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.no_squeeze import no_squeeze_words
from palpate.server.plots.sounds import sound_in
from palpate.server.plots.spectrogram_axes import spectrogram_with_axes
from palpate.server.plots.squeezes import FoundSqueeze, held_by, may_be_squeeze, squeeze_of, squeeze_plot, squeeze_words
from palpate.server.problems import problem
from palpate.store.parts import Head, StoredFile, series_of
from palpate.store.records import Channel, Series
from palpate.store.store import Store
from palpate.store.stored_bytes import StoredBytes

__all__ = [
    "MOST_FILES",
    "MOST_SERIES",
    "Signals",
    "drawn_series",
    "found_squeeze",
    "kind_of",
    "most_numbers",
    "shown_files",
    "shown_signals",
    "sound_of_file",
]

MOST_PLOTS = 12
"""Channels of a series that are drawn."""
MOST_SERIES = MOST_FILES = 60
"""That a page has; of each file the beginning is read."""
LARGEST_SHOWN = 50 << 20
TOO_LONG = f"Stress over strain is not drawn: a page fits lines to {MOST_FITTED:,} samples at most in all."
SAMPLE_BYTES = 2
"""Of a number in a sound file, at least."""


@dataclass(frozen=True)
class Signals:
    """What a page shows of a series.

    `words` are those of the squeeze, or tell why there is none where it looks like one; `sounds` are places of channels
    with their pictures; `without_unit` are names of channels. `too_many` is how many numbers there are where these are
    more than are left for the page, so that nothing is drawn.
    """

    name: str
    position: int
    squeeze: Shown | None
    words: str
    plots: tuple[Shown, ...]
    sounds: tuple[tuple[int, Markup], ...]
    left_out: int
    without_unit: tuple[str, ...]
    too_many: int = 0


def shown_signals(store: Store, head: Head, left: Allowance) -> Iterator[Signals]:
    """The first series of a recording, as far as they may still be read and drawn."""
    for position, info in enumerate(head.series[:MOST_SERIES]):
        if not left.reads(info.numbers):
            yield Signals(info.name, position, None, "", (), (), len(info.channels), (), info.numbers)
            continue
        series = series_of(store, head, position)
        if series is not None:
            yield _drawn(head, series, position, left)


def drawn_series(store: Store, head: Head, memory: Held, position: int) -> Series:
    """A series of which a figure is made, or an error of the request where there is none, or too much to be drawn."""
    numbers = head.series[position].numbers if position < len(head.series) else 0
    if not Allowance(memory=memory).reads(numbers):
        told = f"series {position} has {numbers} numbers, expected {MOST_NUMBERS} at most to be drawn"
        raise problem(422, f"recording {head.id}: {told}", [{"field": "path.position", "detail": told}])
    return found_series(store, head, memory, position)


def found_squeeze(head: Head, series: Series, left: Allowance) -> FoundSqueeze | None:
    """The squeeze in a series of a recording, if it is one to which a line may still be fitted."""
    return squeeze_of(series, held_by(head.setup, head.document["grasp"])) if left.fits(_to_fit(series)) else None


def _to_fit(series: Series) -> int:
    """How many samples a squeeze has, if it may be one."""
    if not may_be_squeeze(one.unit for one in series.channels):
        return 0
    return max(len(one.values) for one in series.channels)


def _drawn(head: Head, series: Series, position: int, left: Allowance) -> Signals:
    """A series with the first of its channels."""
    address, most = f"/recordings/{head.id}/series/{position}", left.draws(min(MOST_PLOTS, len(series.channels)))
    is_long = _to_fit(series) > left.samples
    squeeze = found_squeeze(head, series, left)
    drawn = (
        shown(channel_plot(channel), f"{address}/channels/{place}/plot.json")
        for place, channel in enumerate(series.channels[:most])
    )
    plots = tuple(plot for plot in drawn if plot is not None)
    return Signals(
        name=series.name,
        position=position,
        squeeze=None if squeeze is None else shown(squeeze_plot(squeeze), f"{address}/squeeze.json"),
        words=TOO_LONG if is_long else no_squeeze_words(series) if squeeze is None else squeeze_words(squeeze),
        plots=plots,
        sounds=tuple(
            (place, spectrogram_with_axes(channel, channel.name, f"{address}/channels/{place}/spectrogram.png"))
            for place, channel in enumerate(series.channels[:most])
            if is_sound(channel)
        ),
        left_out=len(series.channels) - len(plots),
        without_unit=tuple(channel.name for channel in series.channels if channel.unit is None),
    )


def shown_files(store: Store, head: Head, left: Allowance) -> list[dict[str, Any]]:
    """The first files, and whether each can be shown as a picture or heard; sounds are drawn as far as is allowed."""
    return [_shown_file(store, head, place, left) for place in range(len(head.files[:MOST_FILES]))]


def _shown_file(store: Store, head: Head, place: int, left: Allowance) -> dict[str, Any]:
    item = head.files[place]
    kind = kind_of(store, item)
    may_be_drawn = kind == "audio" and left.reads(most_numbers(store, item)) and left.draws(1)
    sound = sound_in(store.blobs.get(item.sha256)) if may_be_drawn else None
    address = f"/recordings/{head.id}/files/{place}"
    return {
        "item": item,
        "url": f"/api/v1/recordings/{head.id}/files/{place}",
        "kind": kind,
        "wave": None if sound is None else shown(channel_plot(sound), f"{address}/plot.json"),
        "spectrogram": None if sound is None else spectrogram_with_axes(sound, item.name, f"{address}/spectrogram.png"),
    }


def sound_of_file(store: Store, head: Head, memory: Held, place: int) -> Channel | None:
    """The sound in a file; None where there is none, or too much of it to be drawn."""
    is_there = 0 <= place < len(head.files)
    if not is_there or not Allowance(memory=memory).reads(most_numbers(store, head.files[place])):
        return None
    return sound_in(store.blobs.get(head.files[place].sha256))


def most_numbers(store: Store, item: StoredFile) -> int:
    """How many numbers a sound file may have."""
    return store.blobs.size_bytes(item.sha256) // SAMPLE_BYTES


def kind_of(store: Store, item: StoredFile, largest_bytes: int = LARGEST_SHOWN) -> str:
    """Whether a file may be shown as an ``image`` or heard as ``audio``; ``other`` where it is neither, or larger."""
    kind = item.media_type.partition("/")[0]
    if kind not in ("image", "audio"):
        return "other"
    found = StoredBytes(store.blobs, item.sha256)
    is_safe = found.size <= largest_bytes and safe_type(item.media_type, found.beginning(BEGINNING_BYTES)) != NO_TYPE
    return kind if is_safe else "other"
