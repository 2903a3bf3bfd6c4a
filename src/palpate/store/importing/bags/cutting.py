"""Where in a bag its recordings are: the whole of it, between times, or between the messages of a marker."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, FieldPath
from palpate.store.importing.bags.packets import LATEST_NS
from palpate.store.importing.bags.topics import Cut, Marker, TopicMap

__all__ = ["Span", "Texts", "spans_of"]

WHOLE = Cut(0.0)
NS = 1_000_000_000


@dataclass(frozen=True)
class Span:
    """Where one recording is: from its start to before its stop [ns since 1970], by when messages were written."""

    start_ns: int
    stop_ns: int
    cut: Cut = WHOLE
    notices: tuple[str, ...] = ()

    def __contains__(self, log_ns: int) -> bool:
        """Whether a message of this time belongs to it."""
        return self.start_ns <= log_ns < self.stop_ns


class Texts:
    """What a bag tells by itself in a topic, and when."""

    def __init__(self, messages: Iterable[tuple[int, Any]], path: FieldPath, topic: str) -> None:
        self._topic = topic
        self._told = sorted(
            ((log_ns, _told(message, path, topic)) for log_ns, message in messages), key=lambda one: one[0]
        )

    def __iter__(self) -> Iterator[tuple[int, Any]]:
        """All that was told, with when [ns], in order."""
        return iter(self._told)

    def at(self, span: Span) -> str:
        """What holds for a recording: what was told last before it began, else the first in it.

        Raises
        ------
        StoreError
            If nothing was told up to its end, or no text.
        """
        before = [text for log_ns, text in self._told if log_ns <= span.start_ns]
        within = [text for log_ns, text in self._told if log_ns in span]
        if not before and not within:
            raise StoreError(f"{self._topic}: there is no message for the recording, expected one that tells the text")
        text = before[-1] if before else within[0]
        if not isinstance(text, str):
            raise StoreError(f"{self._topic}: found {text!r}, expected text")
        return text


def spans_of(topics: TopicMap, first_ns: int, marks: Iterable[tuple[int, Any]]) -> list[Span]:
    """The recordings of a bag.

    Parameters
    ----------
    first_ns
        When the first message of any topic was written.
    marks
        What the marker told, with when [ns].

    Raises
    ------
    StoreError
        If there is a marker and no start in the bag.
    """
    if topics.marker is not None:
        return list(_marked(topics.marker, marks))
    cuts = topics.cuts or (WHOLE,)
    return [
        Span(
            first_ns + round(cut.start_s * NS),
            LATEST_NS + 1 if cut.stop_s is None else first_ns + round(cut.stop_s * NS),
            cut,
        )
        for cut in cuts
    ]


def _marked(marker: Marker, marks: Iterable[tuple[int, Any]]) -> Iterator[Span]:
    started: int | None = None
    count = 0
    for log_ns, mark in marks:
        if mark not in (marker.start, marker.stop):
            continue
        if started is not None:
            ended = mark == marker.stop
            told = () if ended else (f"{marker.topic} told no end: the recording ends where the next one starts",)
            yield Span(started, log_ns, notices=told)
        started = log_ns if mark == marker.start else None
        count += mark == marker.start
    if started is not None:
        yield Span(started, LATEST_NS + 1, notices=(f"{marker.topic} told no end: the recording ends with the bag",))
    if not count:
        raise StoreError(f"{marker.topic}: no message holds {marker.start!r}, expected one where a recording starts")


def _told(message: Any, path: FieldPath, topic: str) -> str | int:
    found = path.of(message)
    if found is MISSING:
        raise StoreError(f"{topic}: {path.complaint(message)}")
    if not isinstance(found, str | int):
        raise StoreError(f"{topic} {path.text}: found {type(found).__name__}, expected a text, an integer or a boolean")
    return found
