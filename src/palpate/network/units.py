"""Units: checked when a network is read and when a number arrives, never in the hot path.

Answers for common units ship in ``data/units.json`` (factor to SI base units and dimension), so
that pint, which takes long to import, is only asked for units that are not there.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import count
from math import inf, prod
from pathlib import Path
from threading import Lock
from tokenize import TokenError
from typing import Any

from palpate.errors import PalpateError
from palpate.network.formula import Formula

__all__ = ["Unit", "UnitError", "ask_pint", "dimension_fault", "dimension_of", "factor", "in_units", "unit_of"]

SHIPPED = Path(__file__).parents[1] / "data" / "units.json"
Dimension = Mapping[str, float]
NAMED = {"force": "N", "pressure": "kPa", "density": "kg/m^3", "volume": "cm^3"}
"""Dimensions that have a name, each with a unit."""
LONGEST = 200
LARGEST_POWER = 1000.0
"""All powers of a unit multiplied, as they may be nested."""
POWER = re.compile(
    r"(?:\^|\*\*)\s*(?:\(\s*[-+]?\s*(\d+(?:\.\d+)?)(?:\s*/\s*\d+)?\s*\)|[-+]?\s*(\d+(?:\.\d+)?)(?![\w.]))(?!\s*(?:\^|\*\*))"
)
"""A power that is one number, and has no power of its own."""
NUMBER = re.compile(r"(?<!\w)\.?\d[\w.]*")
"""Beside powers there is only the one of 1/s."""
SUPERSCRIPT = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
AS_DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
MOST_REMEMBERED = 1024
MOST_ASKED = 1000
"""After so many, pint is made anew, as it never forgets what it was asked: whoever sends a number names its unit."""
_ASKING = Lock()
_ASKED = count()


class UnitError(PalpateError, ValueError):
    """A unit that is not known or has the wrong dimension; one sentence, without the place."""


@dataclass(frozen=True)
class Unit:
    """A unit as its factor to SI base units and the exponents of its base dimensions."""

    factor: float
    dimension: Dimension


@lru_cache(maxsize=MOST_REMEMBERED)
def unit_of(text: str) -> Unit:
    """Look up a unit.

    Raises
    ------
    UnitError
        If the unit is not known, or is not a multiple of its base unit (as degrees Celsius).

    Examples
    --------
    >>> unit_of("cm^3")
    Unit(factor=1e-06, dimension={'length': 3.0})
    """
    shipped = _shipped()
    return shipped[text] if text in shipped else ask_pint(text)


@cache
def _shipped() -> Mapping[str, Unit]:
    entries = json.loads(SHIPPED.read_text(encoding="utf-8"))
    return {text: Unit(entry["factor"], entry["dimension"]) for text, entry in entries.items()}


@lru_cache(maxsize=MOST_REMEMBERED)
def ask_pint(text: str) -> Unit:
    """As `unit_of`, from pint instead of the shipped answers.

    Raises
    ------
    UnitError
        If the unit is unknown, or no multiple of a base unit.
    """
    import pint  # its import takes longer than reading a network

    unknown = UnitError(f"unknown unit {text[:100]!r}; expected one such as 'g', 'cm^3', 'kg/m^3', 'kPa'")
    if len(text) > LONGEST or not _is_quick(text):
        raise unknown
    try:
        # the registry is made when it is first asked, and knows no units for whoever asks it meanwhile
        with _ASKING:
            quantity = _registry(next(_ASKED) // MOST_ASKED).Quantity
            zero, one = (quantity(value, text).to_base_units() for value in (0.0, 1.0))
        is_multiple = 0 < one.magnitude < inf
    except (pint.PintError, ArithmeticError, ValueError, TypeError, SyntaxError, TokenError, AssertionError):
        raise unknown from None
    if not is_multiple:
        raise unknown
    if zero.magnitude != 0:
        raise UnitError(f"unit {text!r} has an offset; expected a multiple of a base unit, such as 'K'")
    dimension = {str(name).strip("[]"): float(power) for name, power in sorted(one.dimensionality.items())}
    # 15 digits: pint multiplies 0.01 three times for a cubic centimetre.
    return Unit(float(f"{one.magnitude:.15g}"), dimension)


@lru_cache(maxsize=1)
def _registry(age: int) -> Any:
    """Pint's units, others for another age."""
    import pint

    return pint.UnitRegistry()


def _is_quick(text: str) -> bool:
    """Whether pint tells at once: it works out all that is asked, also nine to the ninth to the ninth."""
    plain = SUPERSCRIPT.sub(lambda found: f"^{found[0].translate(AS_DIGITS)}", text)
    powers = [float(bare or bracketed) for bracketed, bare in POWER.findall(plain)]
    rest = POWER.sub(" ", plain)
    is_plain = "^" not in rest and "**" not in rest and set(NUMBER.findall(rest)) <= {"1"}
    return is_plain and prod(max(1.0, power) for power in powers) <= LARGEST_POWER


def factor(unit_from: str, unit_to: str) -> float:
    """The number that turns a value in one unit into a value in another.

    Raises
    ------
    UnitError
        If a unit is unknown, or the two have different dimensions.

    Examples
    --------
    >>> factor("kg", "g")
    1000.0
    """
    if unit_from == unit_to:
        return 1.0
    source, target = unit_of(unit_from), unit_of(unit_to)
    fault = dimension_fault(unit_from, (unit_to,))
    if fault is not None:
        raise UnitError(fault)
    return float(f"{source.factor / target.factor:.15g}")


def dimension_fault(unit: str, units: Sequence[str]) -> str | None:
    """What is wrong with a unit that shall have the dimension of one of others; None where it has.

    Raises
    ------
    UnitError
        If a unit is unknown.

    Examples
    --------
    >>> dimension_fault("g", ("kg", "N")), dimension_fault("mm", ("kg", "N"))
    (None, "unit 'mm' is length; expected mass, as 'kg', or force, as 'N'")
    """
    found = unit_of(unit).dimension
    wanted = {one: unit_of(one).dimension for one in units}
    if found in wanted.values():
        return None
    expected = ", or ".join(f"{_named(dimension)}, as {one!r}" for one, dimension in wanted.items())
    return f"unit {unit!r} is {_named(found)}; expected {expected}"


def _named(dimension: Dimension) -> str:
    """A dimension by its name, where people have one for it."""
    known = {name: unit_of(unit).dimension for name, unit in NAMED.items()}
    return next((name for name, one in known.items() if one == dimension), None) or _words(dimension)


def in_units(formula: Formula, units: Mapping[str, str], unit: str) -> Formula:
    """The formula over quantities, rewritten over their values in `units`, with a value in `unit`.

    Raises
    ------
    UnitError
        If the dimensions of the formula do not fit together or to `unit`.

    Examples
    --------
    >>> mass_g = in_units(Formula.parse("density * volume"), {"density": "kg/m^3", "volume": "cm^3"}, "g")
    >>> float(mass_g.evaluate({"density": 800.0, "volume": 50.0}))
    40.0
    """
    known = {name: unit_of(units[name]) for name in formula.variables}
    found, wanted = _dimension(formula.tree, {name: u.dimension for name, u in known.items()}), unit_of(unit)
    if found != wanted.dimension:
        raise UnitError(
            f"formula {formula.text!r} gives {_words(found)}; expected {_words(wanted.dimension)}, as unit {unit!r}"
        )
    factors = {name: u.factor for name, u in known.items()}
    if not _is_monomial(formula.tree):
        return formula.scaled(factors, wanted.factor)
    # All factors of a product come out as one: fewer operations, and no rounding for 1e-6 x 1000.
    ones = dict.fromkeys(factors, 1.0)
    total = float(formula.evaluate(factors) / formula.evaluate(ones)) / wanted.factor
    return formula.scaled({}, float(f"{1 / total:.15g}"))


def _is_monomial(node: ast.expr) -> bool:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div | ast.Pow):
        return _is_monomial(node.left) and _is_monomial(node.right)
    return isinstance(node, ast.Name | ast.Constant)


def _dimension(node: ast.expr, dimensions: Mapping[str, Dimension]) -> Dimension:
    """The dimension of an expression that `Formula.parse` has accepted."""
    if isinstance(node, ast.Name):
        return dimensions[node.id]
    if isinstance(node, ast.UnaryOp):
        return _dimension(node.operand, dimensions)
    if isinstance(node, ast.Call):
        inner = _dimension(node.args[0], dimensions)
        if ast.unparse(node.func) == "sqrt":
            return _product(inner, {}, 0.5, 0.0)
        if inner:
            raise UnitError(f"{ast.unparse(node)!r} takes {_words(inner)}; expected a number without a unit")
        return inner
    if isinstance(node, ast.BinOp):
        return _dimension_of_operation(node, dimensions)
    return {}


def _dimension_of_operation(node: ast.BinOp, dimensions: Mapping[str, Dimension]) -> Dimension:
    left, right = _dimension(node.left, dimensions), _dimension(node.right, dimensions)
    if isinstance(node.op, ast.Pow):
        exponent = Formula(node.right, ast.unparse(node.right)).evaluate({})
        return _product(left, {}, float(exponent), 0.0)
    if isinstance(node.op, ast.Mult | ast.Div):
        return _product(left, right, 1.0, 1.0 if isinstance(node.op, ast.Mult) else -1.0)
    if left != right:
        raise UnitError(
            f"{ast.unparse(node)!r} adds {_words(left)} and {_words(right)}; expected both of one dimension"
        )
    return left


def _product(left: Dimension, right: Dimension, left_power: float, right_power: float) -> Dimension:
    powers = {
        name: left.get(name, 0.0) * left_power + right.get(name, 0.0) * right_power for name in sorted({*left, *right})
    }
    return {name: power for name, power in powers.items() if power}


def dimension_of(unit: str) -> str:
    """The dimension of a unit as it stands in a message.

    Examples
    --------
    >>> dimension_of("kPa")
    'length^-1 mass time^-2'
    """
    return _words(unit_of(unit).dimension)


def _words(dimension: Dimension) -> str:
    """A dimension as it stands in a message.

    Examples
    --------
    >>> _words({"length": -3.0, "mass": 1.0})
    'length^-3 mass'
    """
    parts = [name if power == 1 else f"{name}^{power:g}" for name, power in dimension.items()]
    return " ".join(parts) or "a number without a unit"
