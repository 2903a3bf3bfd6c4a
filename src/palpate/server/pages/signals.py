"""What a recording's page shows of its signals: curves, squeezes and sounds, of series and of files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from palpate.server.api.downloads import BEGINNING_BYTES, NO_TYPE, safe_type
from palpate.server.api.sounds import is_sound
from palpate.server.pages.shown import Shown, shown
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.no_squeeze import no_squeeze_words
from palpate.server.plots.sounds import sound_in
from palpate.server.plots.spectrogram_axes import spectrogram_with_axes
from palpate.server.plots.squeezes import FoundSqueeze, held_by, squeeze_of, squeeze_plot, squeeze_words
from palpate.store.parts import Head, StoredFile, series_of
from palpate.store.records import Channel, Series
from palpate.store.store import Store
from palpate.store.stored_bytes import StoredBytes

__all__ = ["Signals", "found_squeeze", "kind_of", "shown_file", "shown_signals", "sound_of_file"]

MOST_PLOTS = 12
"""Channels of a series that are drawn."""
LARGEST_PLOTTED = 20_000_000
"""Samples of a series that are read to be drawn."""
LARGEST_SHOWN = 50 << 20
LARGEST_SOUND = 20 << 20


@dataclass(frozen=True)
class Signals:
    """What a page shows of a series.

    `words` are those of the squeeze, or tell why there is none where it looks like one; `sounds` are places of channels
    with their pictures; `without_unit` are names of channels.
    """

    name: str
    position: int
    squeeze: Shown | None
    words: str
    plots: tuple[Shown, ...]
    sounds: tuple[tuple[int, Markup], ...]
    left_out: int
    without_unit: tuple[str, ...]


def shown_signals(store: Store, head: Head) -> Iterator[Signals]:
    """All series of a recording."""
    for position, info in enumerate(head.series):
        if sum(channel["count"] for channel in info.channels) > LARGEST_PLOTTED:
            yield Signals(info.name, position, None, "", (), (), len(info.channels), ())
            continue
        series = series_of(store, head, position)
        if series is not None:
            yield _drawn(head, series, position)


def found_squeeze(head: Head, series: Series) -> FoundSqueeze | None:
    """The squeeze in a series of a recording, if it is one."""
    return squeeze_of(series, held_by(head.setup, head.document["grasp"]))


def _drawn(head: Head, series: Series, position: int) -> Signals:
    squeeze, address = found_squeeze(head, series), f"/recordings/{head.id}/series/{position}"
    drawn = (
        shown(channel_plot(channel), f"{address}/channels/{place}/plot.json")
        for place, channel in enumerate(series.channels[:MOST_PLOTS])
    )
    plots = tuple(plot for plot in drawn if plot is not None)
    return Signals(
        name=series.name,
        position=position,
        squeeze=None if squeeze is None else shown(squeeze_plot(squeeze), f"{address}/squeeze.json"),
        words=no_squeeze_words(series) if squeeze is None else squeeze_words(squeeze),
        plots=plots,
        sounds=tuple(
            (place, spectrogram_with_axes(channel, channel.name, f"{address}/channels/{place}/spectrogram.png"))
            for place, channel in enumerate(series.channels)
            if is_sound(channel)
        ),
        left_out=len(series.channels) - len(plots),
        without_unit=tuple(channel.name for channel in series.channels if channel.unit is None),
    )


def shown_file(store: Store, head: Head, place: int) -> dict[str, Any]:
    """A file, and whether it can be shown as a picture or heard, and drawn as a sound."""
    item = head.files[place]
    kind = kind_of(store, item)
    sound = sound_of_file(store, head, place) if kind == "audio" else None
    address = f"/recordings/{head.id}/files/{place}"
    return {
        "item": item,
        "url": f"/api/v1/recordings/{head.id}/files/{place}",
        "kind": kind,
        "wave": None if sound is None else shown(channel_plot(sound), f"{address}/plot.json"),
        "spectrogram": None if sound is None else spectrogram_with_axes(sound, item.name, f"{address}/spectrogram.png"),
    }


def sound_of_file(store: Store, head: Head, place: int) -> Channel | None:
    """The sound in a file; None where there is none."""
    if not 0 <= place < len(head.files) or store.blobs.size_bytes(head.files[place].sha256) > LARGEST_SOUND:
        return None
    return sound_in(store.blobs.get(head.files[place].sha256))


def kind_of(store: Store, item: StoredFile, largest_bytes: int = LARGEST_SHOWN) -> str:
    """Whether a file may be shown as an ``image`` or heard as ``audio``; ``other`` where it is neither, or larger."""
    kind = item.media_type.partition("/")[0]
    if kind not in ("image", "audio"):
        return "other"
    found = StoredBytes(store.blobs, item.sha256)
    is_safe = found.size <= largest_bytes and safe_type(item.media_type, found.beginning(BEGINNING_BYTES)) != NO_TYPE
    return kind if is_safe else "other"
