"""Errors of fitting."""

from __future__ import annotations

from palpate.errors import PalpateError

__all__ = ["FittingError"]


class FittingError(PalpateError, ValueError):
    """Data from which a network cannot be made; the message names the file, line and column, or the property."""
