"""Errors of the store."""

from __future__ import annotations

from palpate.errors import PalpateError

__all__ = ["DamagedError", "IncompleteError", "StoreError", "UnavailableError", "UnreadableError"]


class StoreError(PalpateError, ValueError):
    """A recording that cannot be kept, or a store that cannot be used; the message names the field or the place."""


class DamagedError(StoreError):
    """Stored bytes that are missing or are not the ones that were written."""


class UnavailableError(StoreError):
    """A database that cannot be used now, as one that is locked, full or away; what was asked was not done."""


class UnreadableError(UnavailableError):
    """One blob that may not be read, though others may be; it is not known to be damaged."""


class IncompleteError(DamagedError, UnavailableError):
    """A database that lacks tables or columns: nothing is read from them, nor put there."""
