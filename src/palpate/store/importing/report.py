"""What an import did, in numbers, and what was left out with the reason."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from palpate.store.importing.items import Fate, Outcome

__all__ = ["Report"]


@dataclass
class Report:
    """Outcomes, counted as they come; those without a recording are kept with their reasons.

    Attributes
    ----------
    complete
        Whether the import came to its end.
    left
        What was refused or skipped.
    implausible
        The source of what was kept, and what cannot be true in it.

    Examples
    --------
    >>> report = Report()
    >>> report.add(Outcome("a.json", Fate.NEW))
    >>> report.add(Outcome("b.json", Fate.REFUSED, "it is empty"))
    >>> report.counts()
    {'new': 1, 'known': 0, 'mended': 0, 'refused': 1, 'skipped': 0}
    >>> [(left.source, left.reason) for left in report.left]
    [('b.json', 'it is empty')]
    """

    complete: bool = False
    left: list[Outcome] = field(default_factory=list)
    implausible: list[tuple[str, str]] = field(default_factory=list)
    _counter: Counter[Fate] = field(default_factory=Counter)

    def add(self, outcome: Outcome) -> None:
        """Count an outcome."""
        self._counter[outcome.fate] += 1
        if outcome.fate in (Fate.REFUSED, Fate.SKIPPED):
            self.left.append(outcome)
        self.implausible.extend((outcome.source, notice) for notice in outcome.implausible)

    def count(self, fate: Fate) -> int:
        """How many have met this fate."""
        return self._counter[fate]

    def counts(self) -> dict[str, int]:
        """How many have met each fate."""
        return {fate.value: self._counter[fate] for fate in Fate}

    def plain(self) -> dict[str, Any]:
        """The report as JSON can hold it."""
        left = {fate.value: self._plain(fate) for fate in (Fate.REFUSED, Fate.SKIPPED)}
        told = {"implausible": [{"source": source, "notice": notice} for source, notice in self.implausible]}
        return {"format": "palpate-import-report/1", "complete": self.complete, "counts": self.counts(), **left, **told}

    def _plain(self, fate: Fate) -> list[dict[str, str | None]]:
        return [{"source": one.source, "reason": one.reason} for one in self.left if one.fate is fate]
