"""Which channels and images each frame holds: those that all recordings have, as every frame must have all of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

from palpate.errors import plural
from palpate.store.errors import StoreError
from palpate.store.exporting.lerobot.pictures import size_of
from palpate.store.exporting.publication import LackingError
from palpate.store.exporting.selection import Selection

__all__ = ["Features", "Picture", "Signal", "all_untimed", "find_features"]


@dataclass(frozen=True)
class Signal:
    """A channel that is part of the state: where it is, its unit, and the shape of a sample."""

    series: str
    channel: str
    unit: str | None
    shape: tuple[int, ...]

    @property
    def width(self) -> int:
        """How many numbers a sample is."""
        return prod(self.shape)

    @property
    def names(self) -> list[str]:
        """A name with unit for each number of a sample."""
        unit = "" if self.unit is None else f" [{self.unit}]"
        if not self.shape:
            return [f"{self.series}.{self.channel}{unit}"]
        return [f"{self.series}.{self.channel}.{place}{unit}" for place in range(self.width)]


@dataclass(frozen=True)
class Picture:
    """An image that each frame holds: the file, the name of the feature, height and width."""

    file: str
    key: str
    height: int
    width: int


@dataclass(frozen=True)
class Features:
    """What each frame holds, and what was left out and why."""

    signals: tuple[Signal, ...]
    pictures: tuple[Picture, ...]
    notices: tuple[str, ...]

    @property
    def width(self) -> int:
        """How many numbers the state is."""
        return sum(signal.width for signal in self.signals)


@dataclass
class Found:
    """Counts over recordings: those with anything to show, and those that have each channel and each image."""

    total: int
    signals: Counter[Signal]
    untimed: Counter[str]
    images: Counter[tuple[str, tuple[int, int] | None]]


def find_features(selection: Selection, assumed_rate_hz: float | None) -> Features:
    """Look at all recordings.

    Parameters
    ----------
    selection
        The recordings.
    assumed_rate_hz
        Samples per second [Hz] of channels that state neither a rate nor time stamps; they are left out where None.

    Raises
    ------
    LackingError
        If nothing is in all of them, and some could be with an assumed rate.
    StoreError
        If nothing is in all of them otherwise.
    """
    found = _look(selection, assumed_rate_hz)
    signals = tuple(signal for signal, count in found.signals.items() if count == found.total)
    pictures = tuple(_pictures(found))
    notices = tuple(_notices(found))
    if not signals and not pictures and found.untimed:
        raise LackingError({"assumed_rate_hz": _without_rate(found.untimed)})
    if not signals and not pictures:
        why = "; ".join(notices[:2]) or "none has samples or images"
        raise StoreError(
            f"export: found no channel and no image that all recordings have ({why}), expected recordings of one kind, "
            "selected by action or gripper for example"
        )
    return Features(signals, pictures, notices)


def all_untimed(selection: Selection) -> str | None:
    """That nobody knows when any sample was taken, in words; None where it is known of one, or there are images."""
    found: Counter[str] = Counter()
    for outline in selection.outlines():
        signals, untimed = _signals(outline.document["series"], timed=False)
        if signals or any(_is_image(item) for item in outline.document["files"]):
            return None
        found.update(untimed)
    return _without_rate(found) if found else None


def _without_rate(untimed: Counter[str]) -> str:
    named = ", ".join(f"{name} of {plural(count, 'recording')}" for name, count in untimed.most_common(3))
    more = f" and {len(untimed) - 3} more" if len(untimed) > 3 else ""
    return f"neither a rate nor time stamps are stated for {named}{more}, expected samples per second to assume"


def _is_image(item: Mapping[str, Any]) -> bool:
    return bool(item["media_type"].casefold().startswith("image/"))


def _look(selection: Selection, assumed_rate_hz: float | None) -> Found:
    found = Found(0, Counter(), Counter(), Counter())
    for outline in selection.outlines():
        signals, untimed = _signals(outline.document["series"], timed=assumed_rate_hz is not None)
        images = {
            item["name"]: size_of(selection.store.blobs.get(item["sha256"]))
            for item in outline.document["files"]
            if _is_image(item)
        }
        found.signals.update(signals)
        found.untimed.update(untimed)
        found.images.update(images.items())
        found.total += bool(signals or any(images.values()))
    return found


def _signals(series: Iterable[Mapping[str, Any]], *, timed: bool) -> tuple[list[Signal], list[str]]:
    """Channels with samples, and the names of those of which nobody knows when they were."""
    signals, untimed = [], []
    for one in series:
        for channel, count in zip(one["channels"], one["counts"], strict=True):
            signal = Signal(one["name"], channel["name"], channel["unit"], tuple(channel["shape"]))
            if not (count and signal.width):
                continue
            if timed or channel["timed"] or channel["rate_hz"] is not None:
                signals.append(signal)
            else:
                untimed.append(f"{signal.series}.{signal.channel}")
    return signals, untimed


def _pictures(found: Found) -> Iterator[Picture]:
    keys: set[str] = set()
    for (name, size), count in found.images.items():
        if size is not None and count == found.total:
            key = _key(name, keys)
            keys.add(key)
            yield Picture(name, key, *size)


def _key(name: str, taken: set[str]) -> str:
    """A name for the feature of a file, of plain letters as every program takes them, that no other feature has."""
    stem = name.rpartition(".")[0] or name
    plain = "".join(letter if (letter.isascii() and letter.isalnum()) or letter in "_-" else "_" for letter in stem)
    key, number = f"observation.images.{plain}", 1
    while key in taken:
        number += 1
        key = f"observation.images.{plain}_{number}"
    return key


def _notices(found: Found) -> Iterator[str]:
    for signal, count in found.signals.items():
        if count < found.total:
            unit = signal.unit or "unit not stated"
            where = f"{signal.series}.{signal.channel} ({unit}): left out"
            yield f"{where}, only {count} of {found.total} recordings have it"
    for name, count in found.untimed.items():
        yield f"{name}: left out, without a rate or time stamps in {count} (an assumed rate takes it)"
    for (name, size), count in found.images.items():
        if size is None:
            yield f"{name}: left out, no image of eight bits in {count}"
        elif count < found.total:
            yield f"{name}: left out, only {count} of {found.total} recordings have it in {size[1]} x {size[0]}"
