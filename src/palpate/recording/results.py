"""What a measurement returns, as entries of its recording; and the outcomes that recordings hold."""

from __future__ import annotations

import json
import math
import reprlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import cast, get_args

from palpate import outcomes
from palpate.errors import EvidenceError
from palpate.evidence import format_item, parse_item
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Posterior, Reading
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.records import Recording

__all__ = ["OUTCOME", "Outcome", "entries_of", "exact_outcome", "outcome_in", "outcome_of"]

OUTCOME = "outcome.json"
"""The file of a recording that holds its outcome, where the entries do not say all of it."""

Told = tuple[tuple[Entry, ...], tuple[str, ...]]

# a value may be of any size, and one that cannot be shown must not fail the measurement
_SHORT = reprlib.Repr()
_SHORT.maxother = _SHORT.maxstring = 200
_SHORT.maxdict = _SHORT.maxlist = _SHORT.maxtuple = 20


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
    ((), ("the measurement returned {'mass': 118.0} (dict), which is no result: only this notice keeps it",))
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
    told = f"the measurement returned {_SHORT.repr(result)} ({type(result).__name__}), which is no result"
    return (), (" ".join(f"{told}: only this notice keeps it".split()),)


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


def outcome_of(entry: Entry) -> outcomes.Outcome | None:
    """The outcome that an entry stands for; None for an interval, which no outcome says.

    A distribution that is certain stands for a label, any other one for a classifier's probabilities.

    Examples
    --------
    >>> outcome_of(Value("mass", 118.0, unit="g"))
    Reading(value=118.0, sd=None, unit='g')
    >>> outcome_of(Distribution("category", {"mug": 1.0}))
    Label(label='mug')
    """
    match entry:
        case Value(_, value, sd, unit):
            return Reading(value, sd, unit)
        case Bound(_, above, below, unit):
            return Above(above, unit=unit) if above is not None else Below(cast("float", below), unit=unit)
        case Distribution(_, probabilities):
            if len(probabilities) == 1:
                return Label(next(iter(probabilities)))
            return Posterior(dict(probabilities))
        case FailedEntry(reason):
            return Failed(reason)
        case Interval():
            return None


def exact_outcome(action: str, result: object, entries: Sequence[Entry]) -> bytes | None:
    """An outcome as JSON, where the entries that stand for it do not say all of it; None where they do."""
    # failures teach nothing, whatever their words
    if not isinstance(result, get_args(outcomes.Outcome)) or isinstance(result, Failed) or len(entries) != 1:
        return None
    if isinstance(entries[0], FailedEntry) or outcome_of(entries[0]) == result:
        return None
    try:
        return json.dumps(format_item(action, cast("outcomes.Outcome", result)), allow_nan=False).encode()
    except (TypeError, ValueError):
        # not such as a network would take; what can be kept of it is in the entries
        return None


def outcome_in(recording: Recording, property: str) -> tuple[outcomes.Outcome | None, str | None]:
    """The outcome that a recording holds of a property, and why there is none.

    It is read from the file `OUTCOME` where there is one, else from the entry of the property.
    """
    for item in recording.files:
        if item.name == OUTCOME:
            data = item.data.read_bytes() if isinstance(item.data, Path) else item.data
            try:
                return parse_item(json.loads(data))[1], None
            except (EvidenceError, ValueError) as error:
                return None, f"its {OUTCOME} cannot be read: {error}"
    found = [entry for entry in recording.entries if entry.property == property]
    whole = [entry for entry in recording.entries if isinstance(entry, FailedEntry) and entry.property is None]
    if len(found) > 1:
        return None, f"it holds {len(found)} results of {property}"
    if not (found or whole):
        return None, f"it holds no result of {property}"
    outcome = outcome_of((found or whole)[0])
    return outcome, None if outcome is not None else f"it holds an interval of {property}, which no outcome says"
