"""Admission of outcomes: from what a robot or a file says to what a belief can use.

Everything that can be wrong with an outcome is found here, once, so that the engines compute on
evidence they can trust. Every decision taken on the way is told in a notice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from numbers import Real

from palpate.errors import EvidenceError, choices, near
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor, NumberOutcome, NumberSensor
from palpate.network.units import UnitError, factor
from palpate.network.vectors import StateLikelihood, admit_likelihood, admit_posterior
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading

__all__ = ["Admitted", "AdmittedOutcome", "StateLikelihood", "admit"]

AdmittedOutcome = Label | StateLikelihood | Reading | Above | Below | Failed
"""An outcome that was checked: vectors as arrays, numbers in the property's unit (`unit` None)."""


@dataclass(frozen=True, slots=True)
class Admitted:
    """An outcome in its canonical form, and what was decided on the way to it."""

    outcome: AdmittedOutcome
    notices: tuple[str, ...] = ()


def admit(network: Network, action_name: str, outcome: Outcome | StateLikelihood) -> Admitted:
    """Check an outcome of an action and bring it to its canonical form.

    Parameters
    ----------
    outcome
        What the action returned; one that was admitted already comes back as it is.

    Raises
    ------
    EvidenceError
        Unknown action, label or state; an outcome of the wrong kind for the sensor; NaN,
        infinity or a negative number where there can be none; a unit of the wrong dimension.
    """
    action = network.action(action_name)
    if isinstance(outcome, Failed):
        return Admitted(outcome)
    if isinstance(action.sensor, NumberSensor):
        return _admit_number(network, action, action.sensor, outcome)
    return _admit_category(network, action, action.sensor, outcome)


def _admit_category(
    network: Network, action: Action, sensor: ConfusionSensor, outcome: Outcome | StateLikelihood
) -> Admitted:
    where = f"action {action.name!r}"
    measured = network.property(sensor.property)
    assert isinstance(measured, CategoricalProperty)
    match outcome:
        case Label(label):
            if label not in sensor.outcomes:
                hint = near(label, sensor.outcomes)
                raise EvidenceError(f"{where}: unknown label {label!r}{hint}; {choices(sensor.outcomes)}")
            return Admitted(outcome)
        case StateLikelihood(values):
            if values.shape != (len(measured.states),):
                raise EvidenceError(
                    f"{where}: a vector of shape {values.shape} was found, expected one number for each "
                    f"of the {len(measured.states)} states of {measured.name!r}"
                )
            return Admitted(outcome)
        case Likelihood():
            return Admitted(admit_likelihood(where, measured, outcome))
        case Posterior():
            return Admitted(*admit_posterior(where, measured, outcome))
    expected = "it measures states of " + repr(measured.name) + ", expected Label, Likelihood, Posterior or Failed"
    raise EvidenceError(f"{where}: {type(outcome).__name__} was found, but {expected}")


def _admit_number(
    network: Network, action: Action, sensor: NumberSensor, outcome: Outcome | StateLikelihood
) -> Admitted:
    where = f"action {action.name!r}"
    measured = network.property(sensor.property)
    assert not isinstance(measured, CategoricalProperty)
    if not isinstance(outcome, Reading | Above | Below):
        expected = f"it measures a number [{measured.unit}], expected Reading, Above, Below or Failed"
        raise EvidenceError(f"{where}: {type(outcome).__name__} was found, but {expected}")
    number = _in_unit(where, measured.unit, _checked(where, outcome))
    if isinstance(number, Reading):
        return _saturated(where, measured.unit, sensor, number)
    return Admitted(number)


def _checked(where: str, outcome: NumberOutcome) -> NumberOutcome:
    """The outcome with plain finite floats in it."""
    if isinstance(outcome, Reading):
        checked: NumberOutcome = replace(outcome, value=_finite(where, "value", outcome.value))
    else:
        checked = replace(outcome, bound=_finite(where, type(outcome).__name__.lower(), outcome.bound))
    if outcome.sd is None:
        return checked
    sd = _finite(where, "sd", outcome.sd)
    if sd <= 0:
        raise EvidenceError(f"{where}: sd {sd!r} was found, expected a number above zero")
    return replace(checked, sd=sd)


def _finite(where: str, what: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise EvidenceError(f"{where}: {what} {value!r} was found, expected a finite number")
    return float(value)


def _in_unit(where: str, unit: str, outcome: NumberOutcome) -> NumberOutcome:
    """The outcome in the property's unit, `unit` None."""
    if outcome.unit is None:
        return outcome
    try:
        scale = factor(outcome.unit, unit)
    except UnitError as error:
        raise EvidenceError(f"{where}: {error}") from error
    sd = None if outcome.sd is None else outcome.sd * scale
    if isinstance(outcome, Reading):
        return Reading(outcome.value * scale, sd)
    return type(outcome)(outcome.bound * scale, sd)


def _saturated(where: str, unit: str, sensor: NumberSensor, reading: Reading) -> Admitted:
    """The reading, or the bound it lies beyond where the sensor saturates."""
    if reading.value > sensor.high:
        told = f"{where}: {reading.value:g} {unit} is beyond saturation and is read as above {sensor.high:g} {unit}"
        return Admitted(Above(sensor.high, reading.sd), (told,))
    if reading.value < sensor.low:
        told = f"{where}: {reading.value:g} {unit} is beyond saturation and is read as below {sensor.low:g} {unit}"
        return Admitted(Below(sensor.low, reading.sd), (told,))
    return Admitted(reading)
