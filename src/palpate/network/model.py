"""The network: properties, actions with their sensor models, and known objects; frozen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import prod

from palpate.errors import EvidenceError, NetworkError, choices, near
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property
from palpate.network.sensors import Sensor

__all__ = ["MAX_JOINT_STATES", "Action", "KnownObject", "Network", "TrueValue"]

MAX_JOINT_STATES = 10**6


@dataclass(frozen=True, eq=False)
class Action:
    """Something the robot can do, with a cost and the sensor model of what it returns.

    Parameters
    ----------
    cost_s
        Cost in seconds, at least zero.
    sees_appearance
        True where the action only sees the surface (a camera): on an object that looks like
        another one, outcomes are simulated from the other one's true properties.
    """

    name: str
    cost_s: float
    sensor: Sensor
    sees_appearance: bool = False
    description: str = ""


@dataclass(frozen=True)
class TrueValue:
    """A true property of a known object.

    Parameters
    ----------
    value
        A state or a number in the property's unit; what simulation uses.
    status
        ``measured``, ``assumed`` or ``unknown``; an unknown one is a stand-in and never scored.
    source
        Where the value is from.
    """

    value: str | float
    status: str
    source: str = ""

    @property
    def scored(self) -> bool:
        """Whether beliefs may be compared with the value."""
        return self.status != "unknown"


@dataclass(frozen=True)
class KnownObject:
    """An object with known true properties, for simulation and scoring.

    Parameters
    ----------
    looks_like
        Name of the object that this one looks like to actions that see the appearance; None where
        it looks like what it is. An object that looks like another is a trick.
    """

    name: str
    description: str
    truth: Mapping[str, TrueValue]
    looks_like: str | None = None

    @property
    def is_trick(self) -> bool:
        """Whether what the camera sees is not what the object is."""
        return self.looks_like is not None


@dataclass(frozen=True, eq=False)
class Network:
    """A Bayesian network over the properties of an object and the repertoire that measures them.

    Read one with `palpate.load_network`; it is valid once it exists. Order is that of the file and
    is the order of axes, tables and outputs everywhere.
    """

    name: str
    properties: Mapping[str, Property]
    actions: Mapping[str, Action]
    objects: Mapping[str, KnownObject] = field(default_factory=dict)
    description: str = ""

    @cached_property
    def categorical(self) -> tuple[CategoricalProperty, ...]:
        """The categorical properties: the axes of the joint table, in order."""
        return tuple(p for p in self.properties.values() if isinstance(p, CategoricalProperty))

    @cached_property
    def continuous(self) -> tuple[ContinuousProperty, ...]:
        """The continuous properties with a density of their own."""
        return tuple(p for p in self.properties.values() if isinstance(p, ContinuousProperty))

    @cached_property
    def derived(self) -> tuple[DerivedProperty, ...]:
        """The properties that follow from others."""
        return tuple(p for p in self.properties.values() if isinstance(p, DerivedProperty))

    @property
    def joint_states(self) -> int:
        """Number of joint states of the categorical properties."""
        return prod(len(p.states) for p in self.categorical)

    def action(self, name: str) -> Action:
        """The action of that name; EvidenceError lists the valid ones."""
        if name not in self.actions:
            raise EvidenceError(f"unknown action {name!r}{near(name, self.actions)}: {choices(self.actions)}")
        return self.actions[name]

    def property(self, name: str) -> Property:
        """The property of that name; EvidenceError lists the valid ones."""
        if name not in self.properties:
            raise EvidenceError(f"unknown property {name!r}{near(name, self.properties)}: {choices(self.properties)}")
        return self.properties[name]

    def object(self, name: str) -> KnownObject:
        """The known object of that name; EvidenceError lists the valid ones."""
        if name not in self.objects:
            raise EvidenceError(f"unknown object {name!r}{near(name, self.objects)}: {choices(self.objects)}")
        return self.objects[name]

    def with_action(self, action: Action) -> Network:
        """A network that can also do `action`; it replaces one of the same name.

        Raises
        ------
        NetworkError
            If the action's sensor measures a property that the network does not have.
        """
        if action.sensor.property not in self.properties:
            found = repr(action.sensor.property) + near(action.sensor.property, self.properties)
            raise NetworkError(f"action {action.name!r}: unknown property {found}; {choices(self.properties)}")
        return replace(self, actions={**self.actions, action.name: action})
