"""One item of evidence as JSON, in evidence files and in episode logs alike.

An item names the action and says one thing of its outcome::

    {"action": "cat-vision", "label": "mug"}
    {"action": "mat-vision", "likelihood": {"glass": 0.4, "paper": 0.6}}
    {"action": "mat-sound", "posterior": {"glass": 0.4, "paper": 0.6}, "training_prior": {...}, "temperature": 1.5}
    {"action": "weighing", "value": 118, "unit": "g", "sd": 4}
    {"action": "squeezing", "above": 95, "unit": "kPa"}
    {"action": "squeezing", "below": 5}
    {"action": "squeezing", "failed": true, "reason": "lost the grip"}

Here only the form is checked; whether it fits a network is `palpate.network.admission`'s question.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from palpate.errors import EvidenceError, choices, near
from palpate.network.admission import AdmittedOutcome, StateLikelihood
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading

__all__ = ["format_item", "parse_item", "spell_out"]

# What may stand beside each kind of outcome.
COMPANIONS: Mapping[str, tuple[str, ...]] = {
    "label": (),
    "likelihood": (),
    "posterior": ("training_prior", "temperature"),
    "value": ("unit", "sd"),
    "above": ("unit", "sd"),
    "below": ("unit", "sd"),
    "failed": ("reason",),
}


def parse_item(item: object) -> tuple[str, Outcome]:
    """Read one item of evidence: the action's name and the outcome.

    Raises
    ------
    EvidenceError
        If the item is not an object, names no action, holds no kind of outcome or more than one,
        has a key that does not belong, or a value of the wrong type.

    Examples
    --------
    >>> parse_item({"action": "weighing", "value": 118, "unit": "g"})
    ('weighing', Reading(value=118.0, sd=None, unit='g'))
    >>> parse_item({"action": "weighing", "value": 118, "label": "mug"})
    Traceback (most recent call last):
    palpate.errors.EvidenceError: both 'value' and 'label' were found, expected one kind of outcome
    """
    if not isinstance(item, Mapping):
        raise EvidenceError(f"{_shown(item)} was found, expected an object with an action and an outcome")
    if "action" not in item:
        raise EvidenceError("no 'action' was found, expected the name of an action")
    action = _text(item, "action")
    kinds = [key for key in item if key in COMPANIONS]
    if not kinds:
        raise EvidenceError(f"no outcome of action {action!r} was found: {choices(COMPANIONS)}")
    if len(kinds) > 1:
        raise EvidenceError(f"both {kinds[0]!r} and {kinds[1]!r} were found, expected one kind of outcome")
    allowed = ("action", kinds[0], *COMPANIONS[kinds[0]])
    for key in item:
        if key not in allowed:
            raise EvidenceError(f"unknown key {key!r}{near(key, allowed)} beside {kinds[0]!r}: {choices(allowed)}")
    return action, _READERS[kinds[0]](item)


def format_item(action: str, outcome: Outcome) -> dict[str, Any]:
    """Write one item of evidence; `parse_item` gives the same action and outcome back.

    Examples
    --------
    >>> format_item("squeezing", Above(95.0, unit="kPa"))
    {'action': 'squeezing', 'above': 95.0, 'unit': 'kPa'}
    """
    match outcome:
        case Label(label):
            found: dict[str, Any] = {"label": label}
        case Likelihood(values):
            found = {"likelihood": dict(values)}
        case Posterior(probabilities, training_prior, temperature):
            found = {"posterior": dict(probabilities)}
            found |= {} if training_prior is None else {"training_prior": dict(training_prior)}
            found |= {} if temperature == 1 else {"temperature": temperature}
        case Reading(value, sd, unit):
            found = {"value": value, **_present(sd=sd, unit=unit)}
        case Above(bound, sd, unit):
            found = {"above": bound, **_present(sd=sd, unit=unit)}
        case Below(bound, sd, unit):
            found = {"below": bound, **_present(sd=sd, unit=unit)}
        case Failed(reason):
            found = {"failed": True, **_present(reason=reason or None)}
    return {"action": action, **found}


def spell_out(network: Network, action: str, outcome: AdmittedOutcome) -> Outcome:
    """Name what an admitted outcome leaves to the network: the states and the unit."""
    measured = network.property(network.action(action).sensor.property)
    if isinstance(outcome, StateLikelihood):
        assert isinstance(measured, CategoricalProperty)
        return Likelihood(dict(zip(measured.states, outcome.values.tolist(), strict=True)))
    if isinstance(outcome, Reading | Above | Below) and not isinstance(measured, CategoricalProperty):
        number = outcome.value if isinstance(outcome, Reading) else outcome.bound
        return type(outcome)(number, outcome.sd, measured.unit)
    return outcome


def _present(**values: object) -> dict[str, object]:
    return {key: value for key, value in values.items() if value is not None}


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _text(item: Mapping[str, object], key: str) -> str:
    value = item[key]
    if not isinstance(value, str):
        raise EvidenceError(f"{key} {_shown(value)} was found, expected text")
    return value


def _number(item: Mapping[str, object], key: str) -> float:
    value = item[key]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise EvidenceError(f"{key} {_shown(value)} was found, expected a number")
    return float(value)


def _numbers(item: Mapping[str, object], key: str) -> dict[str, float]:
    value = item[key]
    if not isinstance(value, Mapping):
        raise EvidenceError(f"{key} {_shown(value)} was found, expected an object of names and numbers")
    return {name: _number(value, name) for name in value}


def _posterior(item: Mapping[str, object]) -> Posterior:
    prior = _numbers(item, "training_prior") if item.get("training_prior") is not None else None
    return Posterior(_numbers(item, "posterior"), prior, _number(item, "temperature") if "temperature" in item else 1.0)


def _spread(item: Mapping[str, object]) -> tuple[float | None, str | None]:
    """Read the sd and the unit of a number; null says the same as leaving them out."""
    sd = _number(item, "sd") if item.get("sd") is not None else None
    return sd, (_text(item, "unit") if item.get("unit") is not None else None)


def _failed(item: Mapping[str, object]) -> Failed:
    if item["failed"] is not True:
        raise EvidenceError(f"failed {_shown(item['failed'])} was found, expected true or no such key")
    return Failed(_text(item, "reason") if "reason" in item else "")


_READERS: Mapping[str, Callable[[Mapping[str, object]], Outcome]] = {
    "label": lambda item: Label(_text(item, "label")),
    "likelihood": lambda item: Likelihood(_numbers(item, "likelihood")),
    "posterior": _posterior,
    "value": lambda item: Reading(_number(item, "value"), *_spread(item)),
    "above": lambda item: Above(_number(item, "above"), *_spread(item)),
    "below": lambda item: Below(_number(item, "below"), *_spread(item)),
    "failed": _failed,
}
