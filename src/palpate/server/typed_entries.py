"""Results, and numbers among them, as somebody types them into a form."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite

from palpate.store.entries import Distribution, Entry, Value
from palpate.store.errors import StoreError

__all__ = ["typed_entry", "typed_number"]

NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
"""What a person writes for a number; Python takes more, as 1_000, and digits that look like others."""
EXPECTED = "expected a number in digits and a decimal point, such as 118.5 or 1.2e-3"


def typed_number(where: str, text: str) -> float:
    """The number of a field.

    Raises
    ------
    StoreError
        If it is no finite number, or one that would become 0.

    Examples
    --------
    >>> typed_number("value", "1.5e2")
    150.0
    >>> typed_number("value", "1_000")
    Traceback (most recent call last):
    palpate.store.errors.StoreError: value: found '1_000', expected a number in digits and a decimal point, \
such as 118.5 or 1.2e-3
    """
    found = float(text) if NUMBER.fullmatch(text) else None
    if found is None:
        raise StoreError(f"{where}: found {text[:40]!r}, {EXPECTED}")
    if not isfinite(found):
        raise StoreError(f"{where}: found {text[:40]!r}, expected a finite number")
    if found == 0 and any(digit in "123456789" for digit in re.split("[eE]", text)[0]):
        raise StoreError(f"{where}: found {text[:40]!r}, which is too small to be told from 0; {EXPECTED}")
    return found


def typed_entry(fields: Mapping[str, str]) -> Entry:
    """What the fields ``property``, ``value``, ``sd`` and ``unit`` say; a label where there is neither unit nor number.

    Raises
    ------
    StoreError
        Naming the field that is wrong.

    Examples
    --------
    >>> typed_entry({"property": "material", "value": "3d print"})
    Distribution(property='material', probabilities={'3d print': 1.0})
    """
    name, value, sd, unit = (fields.get(key, "") for key in ("property", "value", "sd", "unit"))
    if not value:
        raise StoreError("value: is empty, expected a number, or a label without a unit")
    if not _is_like_a_number(value):
        if unit:
            raise StoreError(f"value: found {value[:40]!r} beside a unit, {EXPECTED}; a label has no unit")
        if sd:
            raise StoreError(f"sd: found {sd[:40]!r} beside the label {value[:40]!r}, expected none: a label has no SD")
        return Distribution(name, {value: 1.0})
    return Value(name, typed_number("value", value), typed_number("sd", sd) if sd else None, unit or None)


def _is_like_a_number(text: str) -> bool:
    """Whether it is no label: something in digits alone, as 1,5 or 1_000, is a number that was written otherwise."""
    try:
        float(text)
    except ValueError:
        return any(map(str.isdecimal, text)) and not any(map(str.isalpha, text))
    return True
