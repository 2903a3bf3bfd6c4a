"""What is known of a property of an object, from the words of the command line."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from palpate.errors import PalpateError, choices, near
from palpate.store.entries import Bound, Distribution, Entry, Interval, Value

if TYPE_CHECKING:
    from palpate.store.store import Store

__all__ = ["check_fits", "entry_of"]

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
FORMS = ("118 g", "118 ± 2 g", "above 95 kPa", "below 5 kPa", "90 to 100 kPa", "ceramic", "ceramic=0.8,glass=0.2")
PLUS_MINUS = r"(?:±|\+/-|\+-)"


def entry_of(name: str, text: str, sd: float | None = None) -> Entry:
    """What is known of a property.

    Examples
    --------
    >>> entry_of("mass", "118 g", 2.0)
    Value(property='mass', value=118.0, sd=2.0, unit='g')
    >>> entry_of("mass", "118 ± 2 g")
    Value(property='mass', value=118.0, sd=2.0, unit='g')
    >>> entry_of("elasticity", "above 95 kPa")
    Bound(property='elasticity', above=95.0, below=None, unit='kPa')
    >>> entry_of("material", "ceramic=0.8,glass=0.2")
    Distribution(property='material', probabilities={'ceramic': 0.8, 'glass': 0.2})
    """
    entry = _entry(name, text.strip())
    if sd is None:
        return entry
    if not isinstance(entry, Value):
        raise PalpateError(f"--sd: {text!r} is no single number, expected a value such as '118 g'")
    if entry.sd is not None:
        raise PalpateError(f"--sd: {text!r} has an SD already, expected one of the two")
    return Value(entry.property, entry.value, sd, entry.unit)


def check_fits(store: Store, entry: Entry, text: str) -> None:
    """Refuse what does not fit to what the store has of the property, or, where it has nothing, to the network.

    Raises
    ------
    PalpateError
        If there is a label in place of a number, or a number in place of a label; if a number has no unit, where the
        store has one; or if a label is new and near to another: one that is meant is told as ``LABEL=1``.
    """
    from palpate.store.labels import has_numbers, labels_of
    from palpate.store.units import units_of

    name = entry.property or ""
    unit, labels = units_of(store).get(name), labels_of(store, name)
    if isinstance(entry, Distribution):
        if not labels and (unit is not None or has_numbers(store, name)):
            raise PalpateError(f"VALUE: {text!r} is a label, and {name} is a number here; expected {_example(unit)}")
        if "=" not in text:
            _check_label(name, text, labels)
    elif labels and unit is None and not has_numbers(store, name):
        raise PalpateError(f"VALUE: {text!r} is a number, and {name} has labels here; {choices(sorted(labels))}")
    elif unit is not None and getattr(entry, "unit", None) is None:
        raise PalpateError(f"VALUE: {text!r} has no unit, expected one such as {unit!r}")


def _check_label(name: str, text: str, labels: frozenset[str]) -> None:
    from palpate.network.properties import CategoricalProperty
    from palpate.network.reading import load_network

    shipped = load_network("household").properties.get(name)
    meant = f"a label that is meant is told as '{text}=1'"
    if isinstance(shipped, CategoricalProperty):
        labels |= frozenset(shipped.states)
    elif shipped is not None and not labels:
        raise PalpateError(f"VALUE: {text!r} is no number, expected {_example(shipped.unit)}; {meant}")
    if text not in labels and (meaning := near(text, labels)):
        raise PalpateError(f"VALUE: {text!r} is no label of {name} here{meaning}; {meant}")


def _example(unit: str | None) -> str:
    return "a number" if unit is None else f"a number with its unit, such as '5 {unit}'"


def _entry(name: str, text: str) -> Entry:
    if re.match(r"[-+]?\d*,\d", text):
        raise PalpateError(f"VALUE: {text!r} was found, expected a point in a number, as in '1.5 g'")
    if found := re.fullmatch(rf"({NUMBER})\s*(.*)", text):
        return _number(name, float(found[1]), found[2].strip())
    if found := re.fullmatch(rf"(above|below)\s+({NUMBER})\s*(.*)", text):
        end: dict[str, Any] = {found[1]: float(found[2])}
        return Bound(name, **end, unit=found[3].strip() or None)
    # a number that is none is no label either
    if not text or re.match(r"[-+]?(nan|inf(inity)?)\b", text, re.IGNORECASE) or re.search(PLUS_MINUS, text):
        raise PalpateError(f"VALUE: {text!r} was found; {choices(FORMS)}")
    return Distribution(name, _probabilities(text))


def _number(name: str, value: float, rest: str) -> Entry:
    """What a number begins: a value, a value with its SD, or an interval."""
    if found := re.fullmatch(rf"to\s+({NUMBER})\s*(.*)", rest):
        return Interval(name, value, float(found[1]), found[2].strip() or None)
    if found := re.fullmatch(rf"{PLUS_MINUS}\s*({NUMBER})\s*(.*)", rest):
        return Value(name, value, float(found[1]), found[2].strip() or None)
    return Value(name, value, unit=rest or None)


def _probabilities(text: str) -> dict[str, float]:
    if "=" not in text:
        return {text: 1.0}
    found = {}
    for part in text.split(","):
        label, _, number = part.rpartition("=")
        if not label.strip() or not re.fullmatch(NUMBER, number.strip()):
            raise PalpateError(f"VALUE: {part!r} was found, expected LABEL=PROBABILITY as in 'ceramic=0.8,glass=0.2'")
        found[label.strip()] = float(number)
    return found
