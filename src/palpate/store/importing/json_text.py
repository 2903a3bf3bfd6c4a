"""JSON as others write it: with numbers of any size, and with NaN."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from palpate.store.errors import StoreError

__all__ = ["finite", "parse_json", "read_json"]

INT_DIGITS = 18
"""Whole numbers of more digits may not fit into 64 bits; they become floats."""


def parse_json(text: str | bytes) -> Any:
    """Parse JSON; whole numbers that 64 bits do not hold become floats, infinite ones too.

    Raises
    ------
    ValueError, RecursionError
        If it is no JSON, or is nested too deeply.

    Examples
    --------
    >>> parse_json("[1, 1" + 400 * "0" + "]")
    [1, inf]
    """
    return json.loads(text, parse_int=lambda digits: int(digits) if len(digits) <= INT_DIGITS else float(digits))


def read_json(path: Path) -> Any:
    """Read a file of JSON in UTF-8.

    Raises
    ------
    StoreError
        If it cannot be read.
    """
    try:
        return parse_json(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise StoreError(f"{path} cannot be read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise StoreError(f"{path}: this is no readable JSON: {error}") from error


def finite(value: Any) -> Any:
    """A value with null in place of each number that JSON does not have.

    Examples
    --------
    >>> finite({"mean": float("nan"), "values": [1.0, float("inf")]})
    {'mean': None, 'values': [1.0, None]}
    """
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    return [finite(item) for item in value] if isinstance(value, list) else value
