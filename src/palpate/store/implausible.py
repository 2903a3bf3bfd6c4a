"""What cannot be true of a recording's results, as a mass below nothing: told, as a sensor may well say so."""

from __future__ import annotations

from palpate.store.entries import Bound, Entry, Interval, Value
from palpate.store.records import Recording

__all__ = ["faults_of", "implausible", "positive_fault"]

POSITIVE = ("area", "density", "elasticity", "frequency", "length", "mass", "volume", "weight")


def implausible(recording: Recording) -> tuple[str, ...]:
    """Each result that cannot be true, with its field.

    It is no part of the recording: what a sensor said stays as it is, as a scale may well show -0.3 g.

    Examples
    --------
    >>> from datetime import UTC, datetime
    >>> from palpate.store.records import ThingRef
    >>> moment, mug = datetime(2024, 5, 1, tzinfo=UTC), ThingRef("ycb", "025_mug")
    >>> implausible(Recording(moment, "weighing", mug, entries=(Value("mass", -5.0, unit="g"),)))
    ('entries[0].value: found -5, expected more than 0, as each mass is',)
    """
    return faults_of(recording.entries)


def faults_of(entries: tuple[Entry, ...]) -> tuple[str, ...]:
    """The same of the results alone."""
    found = ((place, positive_fault(entry)) for place, entry in enumerate(entries))
    return tuple(f"entries[{place}].{fault}" for place, fault in found if fault is not None)


def positive_fault(entry: Entry) -> str | None:
    """Why a result cannot be true of a property that is always positive, with its field; None where it can."""
    if not isinstance(entry, Value | Interval | Bound) or entry.property not in POSITIVE:
        return None
    if isinstance(entry, Value):
        if entry.value > 0:
            return None
        return f"value: found {entry.value:g}, expected more than 0, as each {entry.property} is"
    names = ("low", "high") if isinstance(entry, Interval) else ("above", "below")
    for name in names:
        end = getattr(entry, name)
        if end is not None and end < 0:
            return f"{name}: found {end:g}, expected 0 or more, as each {entry.property} is"
    return None
