"""The forms of recordings."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from palpate.server.api.models.basics import Strict
from palpate.server.api.models.entries import Entry
from palpate.server.api.models.series import SeriesInfo
from palpate.server.api.models.sharing import Kept

__all__ = ["File", "Recording", "RecordingRow"]


class Head(Kept):
    """What a recording tells of itself, in a list and whole."""

    recorded_at: datetime
    uploaded_at: datetime
    action: str
    ground_truth: bool
    entries: list[Entry]
    notices: list[str]


class RecordingRow(Head):
    """A recording as it stands in a list."""

    gripper: str | None


class File(Strict):
    """A file of a recording; `position` is its place there."""

    position: int
    name: str
    media_type: str
    sha256: str
    url: str


class Pose(Strict):
    """Where something was."""

    translation_m: list[float]
    quaternion: list[float] | None
    frame: str
    original: dict[str, Any]


class Recording(Head):
    """A recording whole, but for samples, what is in its files, and its log.

    Who has sent it is told to those with an account.
    """

    uploaded_by: str | None
    licence: str | None
    software: str | None
    repository: str | None
    setup: str
    grasp: dict[str, Any] | None
    gripper_pose: Pose | None
    object_pose: Pose | None
    series: list[SeriesInfo]
    files: list[File]
