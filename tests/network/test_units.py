"""Units: the shipped answers against pint, and errors of dimension."""

import json
import subprocess
import sys

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.network.formula import Formula
from palpate.network.units import SHIPPED, UnitError, ask_pint, factor, in_units, unit_of

AT_ONCE = """
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from palpate.network.units import unit_of

barrier = Barrier(16)

def ask(number):
    barrier.wait()
    return unit_of("A").factor

with ThreadPoolExecutor(16) as threads:
    print(int(sum(threads.map(ask, range(16)))))
"""

PINT = pint.application_registry
NAMES = sorted(json.loads(SHIPPED.read_text(encoding="utf-8")))


@pytest.mark.parametrize("name", NAMES)
def test_pint_agrees_with_the_shipped_answers(name: str) -> None:
    """Every unit in data/units.json has the factor and dimension that pint gives it."""
    base = PINT.Quantity(1.0, name).to_base_units()
    assert unit_of(name).factor == pytest.approx(base.magnitude, rel=1e-14)
    assert unit_of(name).dimension == {str(d).strip("[]"): p for d, p in dict(base.dimensionality).items()}
    assert unit_of(name) == ask_pint(name)


@given(st.sampled_from(NAMES), st.sampled_from(NAMES))
def test_factors_are_inverse_to_each_other(first: str, second: str) -> None:
    """There and back is 1, and units of different dimensions are refused both ways."""
    if unit_of(first).dimension == unit_of(second).dimension:
        assert factor(first, second) * factor(second, first) == pytest.approx(1, rel=1e-13)
    else:
        with pytest.raises(UnitError):
            factor(first, second)


def test_unshipped_units_are_asked_of_pint() -> None:
    """A unit outside the shipped list works as any other."""
    assert factor("pound", "g") == pytest.approx(453.59237)


def test_threads_may_ask_first_at_once() -> None:
    """In a new process, where pint is not loaded yet, no thread is told that a unit is unknown."""
    found = subprocess.run([sys.executable, "-c", AT_ONCE], capture_output=True, text=True, check=True)
    assert found.stdout == "16\n"


def test_shipped_networks_load_without_pint() -> None:
    """Reading every shipped network leaves pint unimported: its import is slow."""
    code = (
        "import sys; from palpate.network.reading import load_network, shipped_networks\n"
        "for name in shipped_networks(): load_network(name)\n"
        "assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("text", ["foo", "kg +", "3 kg", "(", "m3"])
def test_unknown_unit(text: str) -> None:
    """What pint cannot read is one clear error."""
    with pytest.raises(UnitError, match="unknown unit"):
        unit_of(text)


WORK = [
    "9**9**9",
    "2^9999999999*g",
    "9⁹⁹⁹⁹⁹⁹⁹⁹",
    "9**(9*9*9*9*9*9*9*9*9)",
    "9**(2)(9999999)",
    "((m^99)^99)^99",
    "g" * 201,
]
NO_MULTIPLES = ["g/0", "0*g", "-1*g", "(-8)**0.5*g", "9.0**999*g"]
TRIED = """
from palpate.network.units import UnitError, unit_of
for text in {texts!r}:
    try:
        unit_of(text)
    except UnitError:
        print("refused")
"""


def test_a_unit_that_is_a_sum_to_work_out_is_none() -> None:
    """Whoever sends a number names its unit, and pint would work out for hours what stands there."""
    texts = [*WORK, *NO_MULTIPLES]
    code = TRIED.format(texts=texts)
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=20)
    assert found.stdout == "refused\n" * len(texts)


@pytest.mark.parametrize(
    "text", ["m²", "kg·m²·s⁻²", "m**(1/2)", "m^0.5", "(kg*m)^2", "1/s", "cmH2O", "m**(-2)", "s ^ - 2"]
)
def test_powers_of_units_are_read(text: str) -> None:
    """However they are written."""
    assert ask_pint(text).factor > 0


def test_unit_with_an_offset() -> None:
    """Degrees Celsius are not a multiple of kelvin and are refused."""
    with pytest.raises(UnitError, match="has an offset"):
        unit_of("degC")


def test_wrong_dimension_says_both() -> None:
    """The error names what was found and what would be right."""
    with pytest.raises(UnitError, match=r"unit 'kPa' is pressure; expected mass, as 'g'"):
        factor("kPa", "g")


@pytest.mark.parametrize(
    ("text", "units", "unit", "values", "expected"),
    [
        ("density * volume", {"density": "kg/m^3", "volume": "cm^3"}, "g", (800.0, 50.0), 40.0),
        ("density * volume", {"density": "g/mL", "volume": "L"}, "kg", (2.0, 3.0), 6.0),
        ("length ** 3 / 2", {"length": "mm"}, "cm^3", (20.0,), 4.0),
        ("a - a * share", {"a": "mL", "share": "percent"}, "L", (500.0, 40.0), 0.3),
        ("sqrt(area)", {"area": "cm^2"}, "mm", (4.0,), 20.0),
        ("log(a / b)", {"a": "kg", "b": "g"}, "dimensionless", (1.0, 1000.0), 0.0),
        ("-force / depth", {"force": "mN", "depth": "mm"}, "N/m", (6.0, 2.0), -3.0),
    ],
)
def test_formula_in_units(
    text: str, units: dict[str, str], unit: str, values: tuple[float, ...], expected: float
) -> None:
    """A formula over quantities gives the value by hand, whatever the units of its parts."""
    formula = in_units(Formula.parse(text), units, unit)
    found = float(formula.evaluate(dict(zip(units, values, strict=True))))
    assert found == pytest.approx(expected, rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("density + volume", "adds length^-3 mass and length^3"),
        ("density + 1", "adds length^-3 mass and a number without a unit"),
        ("exp(volume) * density", "'exp(volume)' takes length^3"),
        ("density / volume", "gives length^-6 mass; expected mass, as unit 'g'"),
    ],
)
def test_dimensions_that_do_not_fit(text: str, part: str) -> None:
    """A formula whose dimensions do not fit is refused, with the part that does not."""
    with pytest.raises(UnitError) as caught:
        in_units(Formula.parse(text), {"density": "kg/m^3", "volume": "cm^3"}, "g")
    assert part in str(caught.value)
