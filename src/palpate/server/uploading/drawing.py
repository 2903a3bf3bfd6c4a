"""What is seen and heard of a recording that waits: its curves, pictures and sounds, in small and only so many."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from markupsafe import Markup

from palpate.server.api.sounds import is_sound
from palpate.server.pages.allowance import Allowance
from palpate.server.pages.signals import MOST_FILES, MOST_SERIES, found_squeeze, kind_of, most_numbers
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.plot import Plot
from palpate.server.plots.sounds import sound_in
from palpate.server.plots.squeezes import squeeze_plot
from palpate.server.plots.svg import svg
from palpate.store.parts import Head, series_of
from palpate.store.records import Series
from palpate.store.store import Store

__all__ = ["Drawn", "Played", "drawn"]

MOST_CURVES = 4
MOST_PICTURES = 4
MOST_SOUNDS = 4
LARGEST_FILE_BYTES = 20 << 20


@dataclass(frozen=True)
class Played:
    """A picture or a sound: its name, and the address below that of the recording."""

    name: str
    address: str


@dataclass(frozen=True)
class Drawn:
    """Of each so many as are shown, and whether there are more."""

    curves: tuple[Markup, ...] = ()
    pictures: tuple[Played, ...] = ()
    sounds: tuple[Played, ...] = ()
    is_more: bool = False

    def __bool__(self) -> bool:
        return bool(self.curves or self.pictures or self.sounds)


def drawn(scratch: Store, head: Head, left: Allowance) -> Drawn:
    """What a page shows of a recording before it is kept, as far as it may still be read."""
    series = list(_series(scratch, head, left))
    kinds = [kind_of(scratch, item, LARGEST_FILE_BYTES) for item in head.files[:MOST_FILES]]
    plots = list(islice(_plots(scratch, head, series, kinds, left), MOST_CURVES + 1))
    pictures, sounds = list(_files(head, kinds, "image")), [*_sounds(series), *_files(head, kinds, "audio")]
    shown = ((plots, MOST_CURVES), (pictures, MOST_PICTURES), (sounds, MOST_SOUNDS))
    return Drawn(
        tuple(map(svg, plots[:MOST_CURVES])),
        tuple(pictures[:MOST_PICTURES]),
        tuple(sounds[:MOST_SOUNDS]),
        len(series) < len(head.series) or any(len(found) > most for found, most in shown),
    )


def _places(kinds: list[str], wanted: str) -> Iterator[int]:
    return (place for place, kind in enumerate(kinds) if kind == wanted)


def _files(head: Head, kinds: list[str], wanted: str) -> Iterator[Played]:
    return (Played(head.files[place].name, f"files/{place}") for place in _places(kinds, wanted))


def _series(scratch: Store, head: Head, left: Allowance) -> Iterator[tuple[int, Series]]:
    for position, info in enumerate(head.series[:MOST_SERIES]):
        series = series_of(scratch, head, position) if left.reads(info.numbers) else None
        if series is not None:
            yield position, series


def _plots(
    scratch: Store, head: Head, all_series: list[tuple[int, Series]], kinds: list[str], left: Allowance
) -> Iterator[Plot]:
    for _, series in all_series:
        squeeze = found_squeeze(head, series, left)
        if squeeze is not None:
            yield squeeze_plot(squeeze)
        yield from (plot for plot in map(channel_plot, series.channels) if plot is not None)
    for place in _places(kinds, "audio"):
        may_be_read = left.reads(most_numbers(scratch, head.files[place]))
        sound = sound_in(scratch.blobs.get(head.files[place].sha256)) if may_be_read else None
        plot = None if sound is None else channel_plot(sound)
        if plot is not None:
            yield plot


def _sounds(all_series: list[tuple[int, Series]]) -> Iterator[Played]:
    for position, series in all_series:
        for place, channel in enumerate(series.channels):
            if is_sound(channel):
                yield Played(channel.name, f"series/{position}/channels/{place}/sound")
