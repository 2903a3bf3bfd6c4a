"""Recording what a robot measures: one decorator, nothing lost, sent to a store when there is one."""

from __future__ import annotations

from palpate.recording.background import uploading
from palpate.recording.decorator import record
from palpate.recording.measuring import About
from palpate.recording.recorder import Recorder, current_recording
from palpate.recording.results import Outcome
from palpate.recording.spool import Spool
from palpate.recording.uploading import upload

__all__ = ["About", "Outcome", "Recorder", "Spool", "current_recording", "record", "upload", "uploading"]
