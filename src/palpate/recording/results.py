"""What a measurement returns, as entries of its recording."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import cast

from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Posterior, Reading
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value

__all__ = ["Outcome", "entries_of"]

Told = tuple[tuple[Entry, ...], tuple[str, ...]]


class Outcome:
    """Makes the results that a measurement can return.

    Examples
    --------
    >>> Outcome.normal("elasticity", 42.0, sd=10.0, unit="kPa")
    Value(property='elasticity', value=42.0, sd=10.0, unit='kPa')
    >>> Outcome.normal("elasticity", math.nan)
    FailedEntry(reason='the value is nan', property='elasticity')
    """

    @staticmethod
    def normal(property: str, mean: float, *, sd: float | None = None, unit: str | None = None) -> Entry:
        """A number with its standard deviation, in one unit; failed where it is none."""
        if not math.isfinite(mean):
            return FailedEntry(f"the value is {mean}", property)
        return Value(property, float(mean), None if sd is None else float(sd), unit)

    @staticmethod
    def categorical(property: str, probabilities: Mapping[str, float]) -> Entry:
        """Probabilities of labels, which sum to one."""
        return Distribution(property, dict(probabilities))

    @staticmethod
    def interval(property: str, low: float, high: float, *, unit: str | None = None) -> Entry:
        """All that is known is that the property lies between two numbers."""
        return Interval(property, low, high, unit)

    @staticmethod
    def above(property: str, bound: float, *, unit: str | None = None) -> Entry:
        """All that is known is that the property is above a number."""
        return Bound(property, above=bound, unit=unit)

    @staticmethod
    def below(property: str, bound: float, *, unit: str | None = None) -> Entry:
        """All that is known is that the property is below a number."""
        return Bound(property, below=bound, unit=unit)

    @staticmethod
    def failed(reason: str, property: str | None = None) -> Entry:
        """The measurement gave nothing."""
        return FailedEntry(reason, property)


def entries_of(result: object, property: str) -> Told:
    """Return the entries that a returned value stands for, and what was decided on the way.

    Parameters
    ----------
    result
        An entry, several, or an outcome as robots return it; None and anything else give no entry.
    property
        What an outcome is about, as it does not say so itself.

    Examples
    --------
    >>> entries_of(Reading(118.0, unit="g"), "mass")
    ((Value(property='mass', value=118.0, sd=None, unit='g'),), ())
    >>> entries_of({"mass": 118.0}, "mass")
    ((), ('the measurement returned dict, which is no result: it is not kept',))
    """
    if result is None:
        return (), ()
    if isinstance(result, Entry):
        return (result,), ()
    if isinstance(result, list | tuple) and result and all(isinstance(entry, Entry) for entry in result):
        return tuple(cast("list[Entry]", result)), ()
    if isinstance(result, Reading | Above | Below | Failed):
        return (_entry_of_number(result, property),), ()
    if isinstance(result, Label):
        return (Distribution(property, {result.label: 1.0}),), ("the result is a label: it is kept as certain",)
    if isinstance(result, Posterior):
        return _distribution(property, result.probabilities, "probabilities")
    if isinstance(result, Likelihood):
        return _distribution(property, result.values, "likelihoods")
    return (), (f"the measurement returned {type(result).__name__}, which is no result: it is not kept",)


def _entry_of_number(result: Reading | Above | Below | Failed, property: str) -> Entry:
    if isinstance(result, Reading):
        return Outcome.normal(property, result.value, sd=result.sd, unit=result.unit)
    if isinstance(result, Above):
        return Bound(property, above=result.bound, unit=result.unit)
    if isinstance(result, Below):
        return Bound(property, below=result.bound, unit=result.unit)
    return FailedEntry(result.reason or "the action gave nothing", property)


def _distribution(property: str, values: Mapping[str, float], kind: str) -> Told:
    total = math.fsum(values.values())
    if abs(total - 1) < 1e-9 or not (math.isfinite(total) and total > 0):
        return (Distribution(property, dict(values)),), ()
    scaled = {label: value / total for label, value in values.items()}
    return (Distribution(property, scaled),), (f"the {kind} summed to {total:.6g}: they are kept divided by it",)
