"""Results that are no values and no labels, in words: bounds, intervals, failures; those that read alike together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from uuid import UUID

from palpate.server.plots.drawing import number
from palpate.store.visible_results import Given, Result

__all__ = ["Alike", "alike", "in_words"]


@dataclass(frozen=True)
class Alike:
    """How many results read so, and the recording of the first of them."""

    words: str
    count: int
    recording: UUID


def alike(results: Iterable[Result]) -> list[Alike]:
    """Results by what they read, the most frequent first."""
    groups: dict[str, list[UUID]] = {}
    for one in results:
        groups.setdefault(in_words(one), []).append(one.recording)
    found = [Alike(words, len(recordings), recordings[0]) for words, recordings in groups.items()]
    return sorted(found, key=lambda one: -one.count)


def in_words(one: Result) -> str:
    """A result in the unit of its property, or as it was given; its kind, where it has no number."""
    return _number(one if one.given is None else one.given) or one.kind


def _number(one: Result | Given) -> str | None:
    unit = one.unit or "(unit not stated)"
    if one.value is not None:
        return f"{number(one.value)} {unit}"
    if one.low is not None and one.high is not None:
        return f"{number(one.low)} to {number(one.high)} {unit}"
    if one.low is not None:
        return f"above {number(one.low)} {unit}"
    return None if one.high is None else f"below {number(one.high)} {unit}"
