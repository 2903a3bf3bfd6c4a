"""Results in messages: numbers, labels, probabilities of labels."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from palpate.store.entries import Distribution, Entry, FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, FieldPath
from palpate.store.importing.bags.topics import ResultFrom

__all__ = ["result_in"]


def result_in(message: Any, wanted: ResultFrom, where: str, tell: Callable[[str], None]) -> Entry:
    """The result that a message holds: what is not finite has failed, a label is certain, as is told.

    Raises
    ------
    StoreError
        If the message holds none.
    """
    found = _field(message, wanted.path, where)
    if isinstance(found, str):
        tell(f"{where}: the result is a label: it is kept as certain")
        return Distribution(wanted.property, {found: 1.0})
    if wanted.labels:
        return _distribution(found, wanted, where, tell)
    number = _number(found, f"{where} {wanted.path.text}")
    if not math.isfinite(number):
        return FailedEntry(f"the value is {number}", wanted.property)
    sd = wanted.sd
    if wanted.sd_path is not None:
        sd = _number(_field(message, wanted.sd_path, where), f"{where} {wanted.sd_path.text}")
        if not (math.isfinite(sd) and sd >= 0):
            tell(f"{where}: the SD is {sd}: it is left out")
            sd = None
    return Value(wanted.property, number, sd, wanted.unit)


def _field(message: Any, path: FieldPath, where: str) -> Any:
    found = path.of(message)
    if found is MISSING:
        raise StoreError(f"{where}: {path.complaint(message)}")
    return found


def _number(value: Any, where: str) -> float:
    if not isinstance(value, int | float | np.number):
        raise StoreError(f"{where}: found {type(value).__name__}, expected a number, or labels in the map")
    try:
        return float(value)
    except OverflowError:
        raise StoreError(f"{where}: found an integer that is too large, expected a number") from None


def _distribution(found: Any, wanted: ResultFrom, where: str, tell: Callable[[str], None]) -> Entry:
    here = f"{where} {wanted.path.text}"
    if not isinstance(found, list | np.ndarray) or len(found) != len(wanted.labels):
        raise StoreError(
            f"{here}: found {np.size(found)} numbers, expected one for each of {len(wanted.labels)} labels"
        )
    values = [_number(value, here) for value in found]
    total = math.fsum(values)
    if not math.isfinite(total) or total <= 0:
        return FailedEntry(f"the probabilities sum to {total}", wanted.property)
    # classifiers publish 32 bits, and probabilities have to sum to one more closely
    if abs(total - 1) > 1e-6:
        tell(f"{where}: the probabilities summed to {total:.6g}: they are kept divided by it")
    scaled = values if abs(total - 1) < 1e-9 else [value / total for value in values]
    return Distribution(wanted.property, dict(zip(wanted.labels, scaled, strict=True)))
