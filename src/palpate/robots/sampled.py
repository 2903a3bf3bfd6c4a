"""A robot in the world of the network: outcomes are drawn from the sensor models."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

import numpy as np

from palpate.errors import EvidenceError, choices, near
from palpate.network.model import Action, KnownObject, Network, TrueValue
from palpate.network.properties import CategoricalProperty, DerivedProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Below, Label, Outcome, Reading

__all__ = ["SampledRobot"]

Truth = Mapping[str, str | float]


class SampledRobot:
    """Draws outcomes from the sensor models for an object's true properties.

    Actions that only see the appearance are drawn for the object that this one looks like. What
    repetitions share, a hidden label or a common offset, is drawn once and then kept.

    Parameters
    ----------
    thing
        Name of one of the network's objects, a `KnownObject`, or true properties by name: a state
        or a number in the property's unit. A derived property follows from the others where it is
        not given.
    rng
        The only source of chance.

    Raises
    ------
    EvidenceError
        Unknown object, property or state, or a true value that is no finite number.
    """

    def __init__(self, network: Network, thing: str | KnownObject | Truth, rng: np.random.Generator) -> None:
        self._network = network
        self._rng = rng
        self._shared_labels: dict[str, str] = {}
        self._shared_offsets: dict[str, float] = {}
        self.object = _known(network, thing)
        looks = network.object(self.object.looks_like) if self.object.looks_like else self.object
        self._truth, self._appearance = _complete(network, self.object), _complete(network, looks)
        self._able = tuple(a.name for a in network.actions.values() if a.sensor.property in self._seen(a))

    def actions(self) -> tuple[str, ...]:
        """The actions whose property is known of the object, in the order of the network."""
        return self._able

    def perform(self, action: str) -> Outcome:
        """Draw an outcome of the action.

        Raises
        ------
        EvidenceError
            The network does not know the action, or the object's truth does not hold what it measures.
        """
        known = self._network.action(action)
        seen = self._seen(known)
        if known.sensor.property not in seen:
            raise EvidenceError(f"action {action!r}: the object's true {known.sensor.property!r} is not known")
        truth = seen[known.sensor.property]
        if isinstance(known.sensor, ConfusionSensor):
            return self._look(action, known.sensor, str(truth))
        return self._measure(action, known.sensor, float(truth))

    def _seen(self, action: Action) -> Truth:
        return self._appearance if action.sees_appearance else self._truth

    def _look(self, action: str, sensor: ConfusionSensor, state: str) -> Label:
        measured = self._network.property(sensor.property)
        assert isinstance(measured, CategoricalProperty)
        column = sensor.table[:, measured.states.index(state)]
        if action not in self._shared_labels:
            self._shared_labels[action] = self._draw(sensor, column)
        if self._rng.random() < sensor.repeat_probability:
            return Label(self._shared_labels[action])
        return Label(self._draw(sensor, column))

    def _draw(self, sensor: ConfusionSensor, column: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
        # the inverse of the distribution function: Generator.choice does the same, ten times slower
        below = np.cumsum(column)
        return sensor.outcomes[int(np.searchsorted(below, self._rng.random() * below[-1], side="right"))]

    def _measure(self, action: str, sensor: NumberSensor, truth: float) -> Outcome:
        if action not in self._shared_offsets:
            self._shared_offsets[action] = sensor.offset_sd * float(self._rng.standard_normal())
        scale = float(sensor.scale(np.array([truth]))[0])
        value = truth + sensor.bias + self._shared_offsets[action] + scale * sensor.noise.draw(self._rng)
        if value > sensor.high:
            return Above(sensor.high)
        return Below(sensor.low) if value < sensor.low else Reading(value)


def _known(network: Network, thing: str | KnownObject | Truth) -> KnownObject:
    if isinstance(thing, str):
        return network.object(thing)
    if isinstance(thing, KnownObject):
        return thing
    return KnownObject("object", "", {name: TrueValue(value, "assumed") for name, value in thing.items()})


def _complete(network: Network, thing: KnownObject) -> dict[str, str | float]:
    """Check the true values and add the derived ones."""
    truth = {name: _checked(network, thing, name, true.value) for name, true in thing.truth.items()}
    for derived in network.derived:
        if derived.name not in truth and all(name in truth for name in derived.formula.variables):
            truth[derived.name] = _derive(derived, truth)
    return truth


def _derive(derived: DerivedProperty, truth: Truth) -> float:
    return float(derived.formula.evaluate({name: float(truth[name]) for name in derived.formula.variables}))


def _checked(network: Network, thing: KnownObject, name: str, value: str | float) -> str | float:
    measured = network.property(name)
    where = f"object {thing.name!r}: true {name}"
    if isinstance(measured, CategoricalProperty):
        if value not in measured.states:
            hint = near(value, measured.states)
            raise EvidenceError(f"{where} {value!r}{hint} is no state; {choices(measured.states)}")
        return str(value)
    if isinstance(value, str) or not isfinite(value):
        raise EvidenceError(f"{where} {value!r} was found, expected a finite number [{measured.unit}]")
    return float(value)
