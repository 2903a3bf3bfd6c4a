"""Formulas: parsing, evaluation against Python itself, inversion against finite differences."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from palpate.errors import NetworkError
from palpate.network.formula import Formula

POSITIVE = st.floats(0.1, 50)
TEXTS = (
    "a * b",
    "a / b",
    "b / a",
    "a + b",
    "a - b",
    "b - a",
    "-a + 2 * b",
    "sqrt(a) * b",
    "b * exp(a / 20)",
    "log(a) - b",
    "a ** 2 * b",
    "a ** 0.5 + b ** 2",
    "b / (1 + a ** 3)",
)


@pytest.mark.parametrize("text", TEXTS)
@given(a=POSITIVE, b=POSITIVE)
def test_value_is_that_of_python(text: str, a: float, b: float) -> None:
    """A formula evaluates to what Python's own floats give."""
    names = {"a": a, "b": b, "sqrt": math.sqrt, "exp": math.exp, "log": math.log}
    assert float(Formula.parse(text).evaluate({"a": a, "b": b})) == pytest.approx(eval(text, names), rel=1e-12)


@pytest.mark.parametrize("text", TEXTS)
@given(a=POSITIVE, b=POSITIVE)
def test_solving_inverts_evaluation(text: str, a: float, b: float) -> None:
    """Solving for a variable that occurs once gives back the value that was put in."""
    formula = Formula.parse(text)
    value = formula.evaluate({"a": a, "b": b})
    assume(abs(float(value)) > 1e-3)
    found, _ = formula.solve("a", value, {"b": b})
    assert float(found) == pytest.approx(a, rel=1e-5)


@pytest.mark.parametrize("text", TEXTS)
def test_slope_is_the_derivative_of_the_solution(text: str) -> None:
    """The slope that `solve` returns is |da/dvalue|, by central differences."""
    formula, b = Formula.parse(text), 3.0
    value, step = float(formula.evaluate({"a": 2.0, "b": b})), 1e-5
    (up, _), (down, _) = (formula.solve("a", value + sign * step, {"b": b}) for sign in (1, -1))
    _, slope = formula.solve("a", value, {"b": b})
    assert float(slope) == pytest.approx(abs(float(up - down)) / (2 * step), rel=1e-5)


def test_broadcasts_over_arrays() -> None:
    """Values may be arrays of different axes."""
    found = Formula.parse("a * b").evaluate({"a": np.arange(3.0)[:, None], "b": np.arange(4.0)})
    np.testing.assert_array_equal(found, np.outer(np.arange(3), np.arange(4)))


def test_no_solution_is_nan() -> None:
    """A value that no variable reaches has the solution nan: a square root is never negative."""
    found, _ = Formula.parse("sqrt(a)").solve("a", np.array([-1.0, 2.0]), {})
    np.testing.assert_array_equal(found, [np.nan, 4.0])


def test_scaling_changes_units_and_nothing_else() -> None:
    """scaled(factors, result) is formula(factor x variable) / result."""
    formula = Formula.parse("a * b + a")
    found = formula.scaled({"a": 10.0, "b": 0.5}, 4.0).evaluate({"a": 2.0, "b": 6.0})
    assert float(found) == pytest.approx((20 * 3 + 20) / 4)


def test_substitution_composes() -> None:
    """A variable replaced by a formula leaves a formula over the inner variables."""
    outer = Formula.parse("density * contents").substituted({"contents": Formula.parse("capacity * fill")})
    assert outer.variables == ("density", "capacity", "fill")
    assert float(outer.evaluate({"density": 2.0, "capacity": 3.0, "fill": 0.5})) == 3.0


def test_only_variables_that_occur_once_are_solvable() -> None:
    """A variable that occurs twice cannot be isolated step by step."""
    assert Formula.parse("a - a * b").solvable() == ("b",)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("a *", "cannot be read"),
        ("a ** b", "an exponent must be a number"),
        ("sin(a)", "unknown function 'sin'; choose from 'sqrt', 'exp', 'log'"),
        ("a if b else 1", "is not allowed"),
        ("a % b", "is not allowed"),
        ("'text'", "is not allowed"),
        ("True", "is not allowed"),
        ("a.real", "is not allowed"),
        ("__import__('os')", "unknown function"),
        ("sqrt(a, b)", "is not allowed"),
        ("a\x00", "cannot be read"),
    ],
)
def test_what_is_not_arithmetic_is_refused(text: str, part: str) -> None:
    """A formula may hold arithmetic and nothing else; the error quotes it."""
    with pytest.raises(NetworkError) as caught:
        Formula.parse(text)
    assert part in str(caught.value)
    assert repr(text) in str(caught.value)
