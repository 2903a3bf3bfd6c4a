"""Changes to a network: what a world has other than is believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor, Sensor

__all__ = ["Change", "Noise", "PermutedConfusion", "SkewedPrior"]


class Change(Protocol):
    """Makes the network that outcomes are drawn from out of the one that is believed."""

    def apply(self, network: Network) -> Network:
        """The changed network."""


@dataclass(frozen=True)
class Noise:
    """Readings are noisier, or less noisy, than is believed.

    Examples
    --------
    >>> import palpate
    >>> Noise(2.0).apply(palpate.load_network("household")).actions["weighing"].sensor.sd
    12.0
    """

    factor: float

    def apply(self, network: Network) -> Network:
        """Scales the noise of all sensors of numbers."""
        return _with_sensors(network, self._scaled)

    def _scaled(self, sensor: Sensor) -> Sensor:
        if isinstance(sensor, ConfusionSensor):
            return sensor
        return replace(sensor, sd=self.factor * sensor.sd, relative_sd=self.factor * sensor.relative_sd)


@dataclass(frozen=True)
class PermutedConfusion:
    """Labels are confused otherwise than is believed: each state is seen as the one `shift` places before it.

    Examples
    --------
    >>> import palpate
    >>> network = palpate.load_network("household")
    >>> table = PermutedConfusion().apply(network).actions["cat-vision"].sensor.table
    >>> bool((table[:, 1] == network.actions["cat-vision"].sensor.table[:, 0]).all())
    True
    """

    shift: int = 1

    def apply(self, network: Network) -> Network:
        """Rolls the columns of all confusion matrices."""
        return _with_sensors(network, self._rolled)

    def _rolled(self, sensor: Sensor) -> Sensor:
        if isinstance(sensor, NumberSensor):
            return sensor
        return replace(sensor, table=np.roll(sensor.table, self.shift, axis=1))


@dataclass(frozen=True)
class SkewedPrior:
    """Objects are of the kinds that come first far more often than is believed: P(k-th state) ~ 1/k.

    Examples
    --------
    >>> import palpate
    >>> SkewedPrior().apply(palpate.load_network("household")).properties["category"].table.round(2)[:3].tolist()
    [0.34, 0.17, 0.11]
    """

    def apply(self, network: Network) -> Network:
        """Replaces the tables of categorical properties without parents."""
        properties = {
            name: _skewed(p) if isinstance(p, CategoricalProperty) and not p.parents else p
            for name, p in network.properties.items()
        }
        return replace(network, properties=properties)


def _with_sensors(network: Network, changed: Callable[[Sensor], Sensor]) -> Network:
    actions = {name: replace(action, sensor=changed(action.sensor)) for name, action in network.actions.items()}
    return replace(network, actions=actions)


def _skewed(known: CategoricalProperty) -> CategoricalProperty:
    falling = 1 / np.arange(1, len(known.states) + 1)
    return replace(known, table=falling / falling.sum())
