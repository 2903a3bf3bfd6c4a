"""The forms of results in lists, and of properties."""

from __future__ import annotations

from datetime import datetime
from uuid import UUID

from palpate.server.api.models.basics import Strict
from palpate.server.api.models.entries import Entry
from palpate.server.api.models.objects import ThingName

__all__ = ["EntryRow", "Property"]


class EntryRow(Strict):
    """A result with what it is of; numbers as they were given and in SI units."""

    recording: UUID
    recorded_at: datetime
    action: str
    object: ThingName
    gripper: str | None
    ground_truth: bool
    label: str | None
    value_si: float | None
    sd_si: float | None
    entry: Entry


class Property(Strict):
    """A property with the unit that it was first given in; null where it has labels."""

    name: str
    unit: str | None
    entries: int
