"""What can be told of a unit that a store has, which a program that knows more units may have kept."""

from __future__ import annotations

from palpate.network.units import UnitError, factor, unit_of

__all__ = ["are_alike", "factor_of", "is_known_unit", "scale"]


def factor_of(unit: str) -> float | None:
    """The number that turns a value in a unit into SI base units; None where the unit is not known here."""
    try:
        return unit_of(unit).factor
    except UnitError:
        return None


def is_known_unit(unit: str) -> bool:
    """Whether a unit is known here."""
    return factor_of(unit) is not None


def are_alike(unit: str, other: str) -> bool:
    """Whether two units are of one dimension; of one that is not known only the unit itself is known to be.

    Examples
    --------
    >>> are_alike("g", "kg"), are_alike("g", "no such"), are_alike("no such", "no such")
    (True, False, True)
    """
    try:
        return unit == other or unit_of(unit).dimension == unit_of(other).dimension
    except UnitError:
        return False


def scale(unit: str, told: str) -> float | None:
    """By what numbers in a unit are multiplied to be told in another one; None where that cannot be done.

    Examples
    --------
    >>> scale("kg", "g"), scale("kg", "kPa"), scale("no such", "g"), scale("no such", "no such")
    (1000.0, None, None, 1.0)
    """
    return factor(unit, told) if are_alike(unit, told) else None
