"""How often looks at one object repeat a label, from looks at objects whose state is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.fitting.data import Specimen
from palpate.fitting.tables import seen
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor

__all__ = ["FEWEST", "repeat_probability"]

Array = NDArray[np.float64]

FEWEST = 3
"""Objects beside others of their state, and looked at twice, below which nothing is said."""
DIGITS = 3


def repeat_probability(
    network: Network, action: str, sensor: ConfusionSensor, specimens: Sequence[Specimen]
) -> float | None:
    """The probability that a look repeats an object's hidden label; None where the looks do not tell.

    Two looks at one object are the same label by the hidden one with probability r^2, and else as two looks at
    different objects of the state: of their agreement above chance, r^2 is the share within objects.

    Source: the intraclass kappa, as in Fleiss (1981), Statistical Methods for Rates and Proportions, 13.2.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> network = load_network("household")
    >>> repeat_probability(network, "mat-sound", network.actions["mat-sound"].sensor, []) is None
    True
    """
    measured = network.property(sensor.property)
    assert isinstance(measured, CategoricalProperty)
    by_state: dict[int, list[Array]] = {}
    for state, places in seen(measured, action, sensor, specimens):
        by_state.setdefault(state, []).append(np.bincount(places, minlength=len(sensor.outcomes)).astype(float))
    above, room, objects = 0.0, 0.0, 0
    for counts in by_state.values():
        table = np.array(counts)
        several = table.sum(axis=1) > 1
        if len(table) < 2 or not several.any():
            continue
        weight, between = len(table) - 1, _between(table)
        above += weight * (_within(table[several]) - between)
        room += weight * (1 - between)
        objects += weight
    if objects < FEWEST or room <= 0:
        return None
    return round(float(np.sqrt(min(max(above / room, 0.0), 1.0))), DIGITS)


def _within(counts: Array) -> float:
    """Mean over objects of how often two looks at one agree."""
    total = counts.sum(axis=1)
    return float(np.mean((counts * (counts - 1)).sum(axis=1) / (total * (total - 1))))


def _between(counts: Array) -> float:
    """Mean over pairs of objects of how often a look at the one and a look at the other agree."""
    shares = counts / counts.sum(axis=1, keepdims=True)
    pairs = shares.sum(axis=0) @ shares.sum(axis=0) - (shares**2).sum()
    return float(pairs / (len(shares) * (len(shares) - 1)))
