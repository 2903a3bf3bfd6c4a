"""What comes out of a fit: a network, and for each property and each action what its numbers were made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palpate.network.model import Network

__all__ = ["Bias", "Fitted", "PropertyPart", "SensorPart"]

Counts = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PropertyPart:
    """What the numbers of a property were made from.

    Attributes
    ----------
    counts
        Objects: an axis for each parent, and for a categorical property its states last. None where the numbers are the
        template's.
    objects
        Their sum.
    left_out
        Names of objects whose values were too far out to be counted.
    note
        What is to be known of the numbers.
    """

    counts: Counts | None
    objects: int = 0
    left_out: tuple[str, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class Bias:
    """How much readings are above the true value on average, in the property's unit, and how sure that is.

    Attributes
    ----------
    se
        Standard error, objects being the unit.
    sd_without
        The sensor's SD if it were calibrated by that much.
    """

    value: float
    se: float
    sd_without: float


@dataclass(frozen=True, eq=False)
class SensorPart:
    """What the numbers of a sensor were made from.

    Attributes
    ----------
    counts
        Looks, states x outcomes, of a sensor of labels; None otherwise, or where the numbers are the template's.
    objects, readings
        That were used.
    saturated
        Readings of which only a bound is known.
    left_out
        Names of objects with readings too far out to be counted, one for each reading.
    bias
        Of a sensor of a number.
    note
        What is to be known of the numbers.
    """

    counts: Counts | None = None
    objects: int = 0
    readings: int = 0
    saturated: int = 0
    left_out: tuple[str, ...] = ()
    bias: Bias | None = None
    note: str = ""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A network fitted to data.

    Attributes
    ----------
    properties, actions
        By name; derived properties have no numbers and are not there.
    """

    network: Network
    properties: Mapping[str, PropertyPart] = field(default_factory=dict)
    actions: Mapping[str, SensorPart] = field(default_factory=dict)

    @property
    def sensors_only(self) -> bool:
        """Whether no property has new numbers: objects, and what is believed of them beforehand, are as before."""
        return not any(part.objects for part in self.properties.values())

    @property
    def estimated(self) -> tuple[str, ...]:
        """Names of the properties and actions that have new numbers, or counts."""
        properties = [name for name, part in self.properties.items() if part.counts is not None and part.objects]
        sensors = [name for name, part in self.actions.items() if part.counts is not None or part.bias is not None]
        return (*properties, *sensors)
