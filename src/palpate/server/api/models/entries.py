"""The form of a result."""

from __future__ import annotations

from typing import Literal

from palpate.server.api.models.basics import Strict

__all__ = ["Entry"]


class Entry(Strict):
    """A result: a value, a distribution, an interval, a bound, or a failure."""

    kind: Literal["value", "distribution", "interval", "bound", "failed"]
    property: str | None = None
    value: float | None = None
    sd: float | None = None
    unit: str | None = None
    probabilities: dict[str, float] | None = None
    low: float | None = None
    high: float | None = None
    above: float | None = None
    below: float | None = None
    reason: str | None = None
