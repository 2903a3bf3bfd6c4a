"""Texts, numbers and JSON values of a recording: whether every database and file can hold them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from palpate.invisible import hidden_letter
from palpate.store.errors import StoreError

__all__ = [
    "check_encoding",
    "check_json",
    "check_length",
    "check_name",
    "check_number",
    "check_numbers",
    "check_text",
    "check_visible",
]

DEEPEST = 100
LONGEST_NAME = 200
"""Letters of a name: so many fit into an address, whatever they are, and are still read."""
LARGEST_SI = 1e100
"""No physical measurement is larger in SI units; squares and sums of such numbers are numbers too."""


def check_numbers(where: str, numbers: Sequence[float], count: int) -> None:
    """Refuse other than `count` finite numbers."""
    if len(numbers) != count:
        raise StoreError(f"{where}: {len(numbers)} numbers, expected {count}")
    for number in numbers:
        check_number(where, number)


def check_number(where: str, number: object) -> None:
    """Refuse what is no finite number."""
    # numpy's numbers are taken; bool is an int, but no measurement
    if isinstance(number, bool) or not hasattr(number, "__float__"):
        raise StoreError(f"{where}: found {number!r}, expected a finite number")
    try:
        is_finite = math.isfinite(float(number))
    except OverflowError:
        raise StoreError(f"{where}: found a whole number that is too large, expected one below 1e308") from None
    if not is_finite:
        raise StoreError(f"{where}: found {number!r}, expected a finite number")


def check_name(where: str, text: object) -> None:
    """Refuse an empty text, and what `check_text` refuses."""
    if not text:
        raise StoreError(f"{where}: is empty, expected a name")
    check_text(where, text)


def check_visible(where: str, text: object) -> None:
    """Refuse a name that looks like another one, turns what stands around it, or is too long; None is none."""
    if not isinstance(text, str):
        return
    hidden = hidden_letter(text)
    if hidden is not None:
        found = text[:LONGEST_NAME]
        raise StoreError(f"{where}: {hidden}, which nobody sees in {found!r}; expected a name of letters that show")
    check_length(where, text)


def check_length(where: str, text: object) -> None:
    """Refuse a name that is too long to be one; None is none."""
    if isinstance(text, str) and len(text) > LONGEST_NAME:
        told = f"{text[:20]!r} and so on, {len(text):,} letters"
        raise StoreError(f"{where}: found {told}; expected a name of {LONGEST_NAME} at most")


def check_text(where: str, text: object) -> None:
    """Refuse what is neither None nor text that every database can hold."""
    if text is None:
        return
    if not isinstance(text, str):
        raise StoreError(f"{where}: found {text!r}, expected text")
    if "\0" in text:
        raise StoreError(f"{where}: holds a null character, expected text without")
    if not text.isascii():
        check_encoding(where, text)


def check_encoding(where: str, text: str) -> None:
    """Refuse text with halves of surrogate pairs, which no encoding can hold."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise StoreError(f"{where}: character {error.start} is half of a pair, expected text of whole ones") from None


def check_json(where: str, value: object, depth: int = DEEPEST) -> None:
    """Refuse what would come back from JSON as something else, or is nested deeper than readers of JSON go."""
    if value is None:
        return
    if not depth:
        raise StoreError(f"{where}: is nested too deep, expected at most {DEEPEST} levels")
    if isinstance(value, Mapping):
        for key, item in value.items():
            if not isinstance(key, str):
                raise StoreError(f"{where}: found the key {key!r}, expected text")
            check_text(f"{where} key", key)
            check_json(f"{where}.{key}", item, depth - 1)
    elif isinstance(value, list | tuple):
        for place, item in enumerate(value):
            check_json(f"{where}[{place}]", item, depth - 1)
    elif isinstance(value, float) and not math.isfinite(value):
        raise StoreError(f"{where}: found {value}, which JSON cannot hold; expected a finite number")
    elif isinstance(value, str):
        check_text(where, value)
    elif not isinstance(value, bool | int | float):
        raise StoreError(f"{where}: found {type(value).__name__}, expected what JSON can hold")
