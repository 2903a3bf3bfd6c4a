"""What is in a selection, counted: whatever an export says of itself comes from here."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from hashlib import sha256
from typing import Any

from palpate.store.exporting.selection import Outline, Selection
from palpate.store.records import Setup, ThingRef

__all__ = ["Census", "take_census"]


@dataclass
class Census:
    """Counts over recordings.

    Attributes
    ----------
    digests
        Of the recordings.
    first, last
        When the first and the last were recorded; None where there are no recordings.
    things, setups
        Objects by dataset and name, setups by digest.
    measured
        Recordings by object and action.
    used
        Recordings by setup.
    licences, owners, software, visibilities
        Recordings by what is stated; None where it is not.
    results
        Results by property, kind and unit.
    channels
        Recordings by series, channel, quantity and unit.
    media
        Files by media type.
    notices
        Recordings by what was odd.
    truths
        Recordings whose results are known to be true.
    """

    digests: list[bytes] = field(default_factory=list)
    first: datetime | None = None
    last: datetime | None = None
    things: dict[tuple[str, str], ThingRef] = field(default_factory=dict)
    setups: dict[str, Setup] = field(default_factory=dict)
    measured: Counter[tuple[tuple[str, str], str]] = field(default_factory=Counter)
    used: Counter[str] = field(default_factory=Counter)
    licences: Counter[str | None] = field(default_factory=Counter)
    owners: Counter[str | None] = field(default_factory=Counter)
    software: Counter[str | None] = field(default_factory=Counter)
    visibilities: Counter[str | None] = field(default_factory=Counter)
    results: Counter[tuple[str | None, str, str | None]] = field(default_factory=Counter)
    channels: Counter[tuple[str, str, str, str | None]] = field(default_factory=Counter)
    media: Counter[str] = field(default_factory=Counter)
    notices: Counter[str] = field(default_factory=Counter)
    truths: int = 0

    @property
    def recordings(self) -> int:
        """How many recordings there are."""
        return len(self.digests)

    @property
    def digest(self) -> str:
        """SHA-256 of the digests of all recordings, in order of size: the same recordings have the same one."""
        return sha256(b"".join(sorted(self.digests))).hexdigest()

    @property
    def actions(self) -> list[str]:
        """What was done, the most frequent first."""
        counts: Counter[str] = Counter()
        for (_, action), count in self.measured.items():
            counts[action] += count
        return sorted(counts, key=lambda action: (-counts[action], action))

    def add(self, outline: Outline) -> None:
        """Count a recording."""
        moment, key = outline.recorded_at, (outline.thing.dataset, outline.thing.id)
        self.digests.append(outline.digest)
        self.first = moment if self.first is None else min(self.first, moment)
        self.last = moment if self.last is None else max(self.last, moment)
        self.things.setdefault(key, outline.thing)
        self.setups.setdefault(outline.document["setup"], outline.setup)
        self.measured[key, outline.document["action"]] += 1
        self.used[outline.document["setup"]] += 1
        self.visibilities[outline.visibility] += 1
        self._add_document(outline.document)

    def _add_document(self, document: Mapping[str, Any]) -> None:
        # a text without letters says as little as none
        self.licences[(document["licence"] or "").strip() or None] += 1
        self.owners[(document["owner"] or "").strip() or None] += 1
        self.software[document["software"] or None] += 1
        self.truths += document["ground_truth"]
        self.notices.update(dict.fromkeys(document["notices"], 1))
        for entry in document["entries"]:
            self.results[entry["property"], entry["kind"], entry.get("unit")] += 1
        for series in document["series"]:
            for channel in series["channels"]:
                self.channels[series["name"], channel["name"], channel["quantity"], channel["unit"]] += 1
        for item in document["files"]:
            self.media[item["media_type"]] += 1


def take_census(selection: Selection) -> Census:
    """Count all recordings of a selection."""
    census = Census()
    for outline in selection.outlines():
        census.add(outline)
    return census
