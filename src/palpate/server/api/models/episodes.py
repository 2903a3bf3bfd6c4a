"""The forms of explorations."""

from __future__ import annotations

from datetime import datetime
from typing import Any
from uuid import UUID

from palpate.server.api.models.basics import Strict
from palpate.server.api.models.sharing import Kept

__all__ = ["Episode", "EpisodeProgress", "EpisodeRow"]


class EpisodeRow(Kept):
    """An exploration as it stands in a list; `stop` is null where it was interrupted."""

    started_at: datetime
    network: str
    objective: str
    policy: str
    robot: str
    actions: int
    stop: str | None


class Step(Strict):
    """A line of an episode's log, with the recording of the action where there is one to see."""

    record: dict[str, Any]
    recording: UUID | None


class Episode(EpisodeRow):
    """An exploration whole."""

    header: dict[str, Any]
    steps: list[Step]


class EpisodeProgress(Strict):
    """How far an exploration is: lines of its log after the first; why it stopped; its page for people."""

    id: UUID
    lines: int
    stop: str | None
    page: str
