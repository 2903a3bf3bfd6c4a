"""What a network is fitted to: objects, what is known of each, and what was measured on it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from palpate.errors import choices, near
from palpate.fitting.errors import FittingError
from palpate.network.admission import AdmittedOutcome
from palpate.network.document import is_number
from palpate.network.families import Gamma, LogNormal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property
from palpate.network.units import UnitError, factor

__all__ = ["Data", "Source", "Specimen", "Truth", "completed", "true_value", "unit_factor"]

Truth = Mapping[str, str | float]
AGREEMENT = 0.05
"""A derived value that was measured may differ from its formula by this fraction before it is told."""


@dataclass(frozen=True)
class Source:
    """Where data are from.

    Attributes
    ----------
    kind
        ``csv`` or ``store``.
    name
        The file, or the store without its password.
    sha256
        Of the file, or of the digests of the recordings that were used and what is known of objects.
    items
        Number of rows, or of recordings.
    first, last
        ISO 8601 times of the first and the last recording; empty for files.
    """

    kind: str
    name: str
    sha256: str
    items: int
    first: str = ""
    last: str = ""


@dataclass(frozen=True)
class Specimen:
    """An object with known properties and what was measured on it.

    Attributes
    ----------
    truth
        Known properties: a state, or a number in the property's unit.
    readings
        Action to its outcomes, admitted; failed ones are left out.
    """

    name: str
    truth: Truth
    readings: Mapping[str, Sequence[AdmittedOutcome]] = field(default_factory=dict)


@dataclass(frozen=True)
class Data:
    """Specimens in the order of their names, where they are from, and what was decided on the way."""

    specimens: tuple[Specimen, ...]
    sources: tuple[Source, ...] = ()
    notices: tuple[str, ...] = ()

    @classmethod
    def of(cls, specimens: Iterable[Specimen], sources: Iterable[Source] = (), notices: Iterable[str] = ()) -> Data:
        """Data whose order depends on names alone, so that results do not depend on the order of rows."""
        return cls(tuple(sorted(specimens, key=lambda one: one.name)), tuple(sources), tuple(notices))


def true_value(prop: Property, value: str | float, unit: str | None = None) -> str | float:
    """A known value of a property, checked, in its unit.

    Raises
    ------
    FittingError
        An unknown state, a number that is not finite or outside the support, a unit of the wrong dimension; without
        the place.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> true_value(load_network("household").property("mass"), 0.118, "kg")
    118.0
    """
    if isinstance(prop, CategoricalProperty):
        if value not in prop.states:
            raise FittingError(
                f"found the unknown state {value!r} of {prop.name!r}{near(value, prop.states)}; {choices(prop.states)}"
            )
        return str(value)
    number = math.nan if isinstance(value, str) else float(value) * unit_factor(unit, prop.unit)
    # a network file takes no larger ones
    if not is_number(number) or math.isnan(number):
        raise FittingError(f"found {value!r}; expected a finite number of {prop.name!r} [{prop.unit}]")
    if isinstance(prop, ContinuousProperty):
        _check_support(prop, number)
    return number


def unit_factor(unit: str | None, wanted: str) -> float:
    """The number that turns values in a unit, None for the same, into values in the one that is wanted.

    Raises
    ------
    FittingError
        The unit is unknown or of another dimension; without the place.
    """
    try:
        return 1.0 if unit is None else factor(unit, wanted)
    except UnitError as error:
        raise FittingError(f"found an {error}" if "unknown" in str(error) else str(error)) from None


def _check_support(prop: ContinuousProperty, value: float) -> None:
    low, high = float(np.min(prop.family.low)), float(np.max(prop.family.high))
    above = isinstance(prop.family, LogNormal | Gamma)
    if low < value < high or (not above and low <= value <= high):
        return
    words = f"above {low:g}" if above else f"from {low:g} to {high:g}"
    raise FittingError(
        f"found {value:g} {prop.unit}; expected {prop.name!r} {words} {prop.unit}, as the network has it"
    )


def completed(network: Network, truth: Truth) -> tuple[dict[str, str | float], tuple[str, ...]]:
    """Known properties with those that follow from them by formulas, and what was odd.

    A derived property follows from its variables; where it is known itself and one of them is not, that one follows.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> completed(load_network("household"), {"mass": 118.0, "volume": 15.0})[0]["density"]
    7866.666666666667
    """
    values: dict[str, str | float] = dict(truth)
    odd: list[str] = []
    for derived in network.derived:
        missing = [name for name in derived.formula.variables if name not in values]
        if derived.name in values and len(missing) == 1 and missing[0] in derived.formula.solvable():
            odd += _solve(network, derived, missing[0], values)
    for derived in network.derived:
        if all(name in values for name in derived.formula.variables):
            odd += _settle(derived, values)
    return {name: values[name] for name in network.properties if name in values}, tuple(odd)


def _settle(derived: DerivedProperty, values: dict[str, str | float]) -> list[str]:
    """Fill in a derived value, or keep the one that was measured and tell where it does not fit."""
    with np.errstate(all="ignore"):
        result = float(derived.formula.evaluate({name: float(values[name]) for name in derived.formula.variables}))
    if derived.name in values:
        known = float(values[derived.name])
        if abs(known - result) <= AGREEMENT * abs(known):
            return []
        return [f"known {derived.name} differs from {derived.formula.text} by more than {AGREEMENT:.0%}; both are kept"]
    if math.isfinite(result):
        values[derived.name] = result
    return []


def _solve(network: Network, derived: DerivedProperty, name: str, values: dict[str, str | float]) -> list[str]:
    others = {other: float(values[other]) for other in derived.formula.variables if other != name}
    found, _ = derived.formula.solve(name, float(values[derived.name]), others)
    try:
        values[name] = true_value(network.property(name), float(found))
    except FittingError:
        return [f"{name} cannot follow from {derived.name} = {derived.formula.text}, and is not known"]
    return [f"{name} follows from {derived.name} = {derived.formula.text}"]
