import pytest

from palpate.network.units import unit_of
from palpate.store.errors import StoreError
from palpate.store.quantities import QUANTITIES, check_quantity


@pytest.mark.parametrize(
    ("name", "right", "wrong"),
    [
        ("position", ["mm", "degree", "percent"], ["kg", "A", "s"]),
        ("current", ["A", "mA"], ["N", "V", "dimensionless"]),
        ("force", ["N", "kN"], ["kg", "N*m", "kPa"]),
        ("torque", ["N*m"], ["N", "W"]),
        ("mass", ["g", "kg"], ["N", "cm^3", "kPa"]),
        ("elasticity", ["kPa", "N/mm^2"], ["g", "N/mm", "percent"]),
        ("density", ["kg/m^3", "g/cm^3"], ["kg", "g/cm^2"]),
        ("volume", ["cm^3", "mL"], ["cm^2", "g"]),
        ("temperature", ["K"], ["degC", "J"]),
        ("audio", ["dimensionless", "Pa", "V"], ["m", "Hz"]),
        ("fluff", ["g", "kPa"], ["no such unit"]),
    ],
)
def test_what_everybody_knows_has_its_dimension(name: str, right: list[str], wrong: list[str]) -> None:
    """Every unit of a right dimension will do and no other; of a lab's own quantity any known unit."""
    for unit in right:
        check_quantity("here", unit, name)
    for unit in wrong:
        with pytest.raises(StoreError, match=r"^here: un"):
            check_quantity("here", unit, name)


def test_dimensions_of_one_quantity_differ() -> None:
    """No unit stands in the table twice, under another name."""
    for units in QUANTITIES.values():
        dimensions = [tuple(unit_of(unit).dimension.items()) for unit in units]
        assert len(set(dimensions)) == len(dimensions)
