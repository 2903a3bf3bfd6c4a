"""Where a page of a list ends, as text that somebody brings back, and may have changed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from palpate.store.errors import StoreError
from palpate.store.texts import check_text
from palpate.store.unpadded import from_unpadded, to_unpadded

__all__ = ["cursor_text", "place_of"]

LARGEST = 1 << 63
"""Whole numbers from here on are none that a database can look for."""


def cursor_text(place: Sequence[object]) -> str:
    """A place in a list as text."""
    return to_unpadded(json.dumps(place).encode())


def place_of(text: str) -> list[Any] | None:
    """What `cursor_text` was given; None for any other text, and for a place that no database can look for.

    Examples
    --------
    >>> place_of(cursor_text(["lab", "cup"])), place_of(cursor_text([1 << 63])), place_of("mug")
    (['lab', 'cup'], None, None)
    """
    try:
        place = json.loads(from_unpadded(text))
    except (ValueError, RecursionError):
        return None
    return place if isinstance(place, list) and all(map(_can_be_asked, place)) else None


def _can_be_asked(part: object) -> bool:
    if isinstance(part, int):
        return -LARGEST <= part < LARGEST
    try:
        check_text("cursor", part)
    except StoreError:
        return False
    return part is not None
