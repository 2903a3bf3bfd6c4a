"""The bench's errors."""

from __future__ import annotations

from palpate.errors import PalpateError

__all__ = ["BenchError"]


class BenchError(PalpateError):
    """A bench that cannot be set up: the message names the object or the file, and what would be right."""
