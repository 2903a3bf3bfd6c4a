"""Quantities and properties that everybody knows, and what dimension each has."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.network.units import UnitError, dimension_fault, unit_of
from palpate.store.errors import StoreError
from palpate.store.remembering import remembered

__all__ = ["QUANTITIES", "check_quantity", "quantity_fault"]

QUANTITIES: Mapping[str, tuple[str, ...]] = {
    "acceleration": ("m/s^2",),
    "angle": ("rad",),
    "angular_velocity": ("rad/s",),
    "area": ("m^2",),
    "audio": ("dimensionless", "Pa", "V"),
    "charge": ("C",),
    "current": ("A",),
    "density": ("kg/m^3",),
    "distance": ("m",),
    "elasticity": ("Pa",),
    "energy": ("J",),
    "force": ("N",),
    "frequency": ("Hz",),
    "length": ("m",),
    "load": ("kg", "N", "dimensionless"),
    "mass": ("kg",),
    "position": ("m", "dimensionless"),
    "power": ("W",),
    "pressure": ("Pa",),
    "stress": ("Pa",),
    "temperature": ("K",),
    "time": ("s",),
    "torque": ("N*m",),
    "velocity": ("m/s",),
    "voltage": ("V",),
    "volume": ("m^3",),
    "weight": ("kg", "N"),
}
"""A unit of each dimension that a quantity may have: a position is in mm, in degrees or in per cent, and not in kg.

Of a quantity that is not here any unit will do; where it is a property, the first one that a store is given decides.
"""


def check_quantity(where: str, unit: str | None, name: str) -> None:
    """Refuse a unit that is unknown, or of another dimension than a quantity or property of this name has.

    Examples
    --------
    >>> check_quantity("series[0].position.unit", "kg", "position")
    Traceback (most recent call last):
    palpate.store.errors.StoreError: series[0].position.unit: unit 'kg' is mass; expected length, as 'm', or a number \
without a unit, as 'dimensionless'
    """
    fault = None if unit is None else quantity_fault(unit, name)
    if fault is not None:
        raise StoreError(f"{where}: {fault}")


@remembered(1024)
def quantity_fault(unit: str, name: str) -> str | None:
    """What is wrong with a unit of a quantity or property; None where nothing is."""
    try:
        unit_of(unit)
    except UnitError as error:
        return str(error)
    return dimension_fault(unit, QUANTITIES[name]) if name in QUANTITIES else None
