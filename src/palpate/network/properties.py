"""Properties: the variables of the network."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.network.families import Family
from palpate.network.formula import Formula

__all__ = ["CategoricalProperty", "ContinuousProperty", "DerivedProperty", "Property"]


@dataclass(frozen=True, eq=False)
class CategoricalProperty:
    """A property with named states.

    Parameters
    ----------
    table
        P(state | parents) with an axis per parent, in their order, and the states last; the last
        axis sums to one.
    """

    name: str
    states: tuple[str, ...]
    parents: tuple[str, ...]
    table: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ContinuousProperty:
    """A property with a density given the states of its categorical parents (an axis each)."""

    name: str
    unit: str
    parents: tuple[str, ...]
    family: Family


@dataclass(frozen=True, eq=False)
class DerivedProperty:
    """A property that follows from continuous properties by a formula.

    Parameters
    ----------
    formula
        As it is evaluated: over continuous properties (never derived ones), in their units,
        giving a value in `unit`.
    """

    name: str
    unit: str
    formula: Formula


Property = CategoricalProperty | ContinuousProperty | DerivedProperty
