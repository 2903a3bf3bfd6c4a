"""Errors of recording."""

from __future__ import annotations

from palpate.errors import PalpateError

__all__ = ["RecordingError"]


class RecordingError(PalpateError):
    """A measurement that cannot be recorded as asked, or a spool that cannot be used."""
