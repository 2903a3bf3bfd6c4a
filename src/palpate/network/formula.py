"""Formulas of derived properties: parsed once, evaluated on arrays, inverted for one variable."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.errors import NetworkError, choices, near

__all__ = ["Formula"]

Array = NDArray[np.float64]
Step = Callable[[Array], tuple[Array, Array]]

FUNCTIONS: Mapping[str, Callable[[Array], Array]] = {"sqrt": np.sqrt, "exp": np.exp, "log": np.log}
OPERATORS: Mapping[type[ast.operator], Callable[..., Array]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
}


@dataclass(frozen=True)
class Formula:
    """An arithmetic expression over named variables.

    Numbers, ``+ - * / **``, parentheses and the functions sqrt, exp and log may occur.

    Examples
    --------
    >>> mass_g = Formula.parse("density * volume / 1000")
    >>> mass_g.variables
    ('density', 'volume')
    >>> float(mass_g.evaluate({"density": 800.0, "volume": 50.0}))
    40.0
    >>> volume, slope = mass_g.solve("volume", 40.0, {"density": 800.0})
    >>> float(volume), float(slope)
    (50.0, 1.25)
    """

    tree: ast.expr
    text: str

    @classmethod
    def parse(cls, text: str) -> Formula:
        """Read a formula; NetworkError names what is not allowed in it."""
        try:
            tree = ast.parse(text, mode="eval").body
        except (SyntaxError, ValueError) as error:
            raise NetworkError(f"formula {text!r} cannot be read: {error.args[0]}") from None
        _check(tree, text)
        return cls(tree, text)

    @property
    def variables(self) -> tuple[str, ...]:
        """The variables in the order in which they first occur."""
        return tuple(dict.fromkeys(_names(self.tree)))

    def evaluate(self, values: Mapping[str, Array | float]) -> Array:
        """The value of the formula, broadcast over the values given."""
        return _evaluate(self.tree, values)

    def scaled(self, factors: Mapping[str, float], result: float) -> Formula:
        """The formula over variables in other units: formula(factor x variable) / result."""
        tree: ast.expr = _substitute(
            self.tree, {name: _times(ast.Name(name), factor) for name, factor in factors.items()}
        )
        return Formula(_times(tree, 1 / result), self.text)

    def substituted(self, formulas: Mapping[str, Formula]) -> Formula:
        """The formula with variables replaced by formulas."""
        return Formula(_substitute(self.tree, {name: f.tree for name, f in formulas.items()}), self.text)

    def solvable(self) -> tuple[str, ...]:
        """The variables for which `solve` works: those that occur once."""
        names = list(_names(self.tree))
        return tuple(name for name in self.variables if names.count(name) == 1)

    def solve(self, name: str, value: Array | float, others: Mapping[str, Array | float]) -> tuple[Array, Array]:
        """Value of the variable `name`, which occurs once, at which the formula has `value`.

        Returns
        -------
        solution, slope
            The variable, nan where there is none, and the absolute derivative of the variable by
            the value: what a change of variables needs.
        """
        node, target, slope = self.tree, np.asarray(value, float), np.asarray(1.0)
        with np.errstate(all="ignore"):
            while not isinstance(node, ast.Name):
                node, step = _undo(node, name, others)
                target, factor = step(target)
                slope = slope * factor
        return target, np.abs(slope)


def _check(node: ast.AST, text: str) -> None:
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        if isinstance(node.op, ast.Pow) and any(_names(node.right)):
            raise NetworkError(f"formula {text!r}: an exponent must be a number, not a variable; use exp(...) for that")
        parts: list[ast.expr] = [node.left, node.right]
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        parts = [node.operand]
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and len(node.args) == 1 and not node.keywords:
        if node.func.id not in FUNCTIONS:
            found = repr(node.func.id) + near(node.func.id, FUNCTIONS)
            raise NetworkError(f"formula {text!r}: unknown function {found}; {choices(FUNCTIONS)}")
        parts = [node.args[0]]
    elif isinstance(node, ast.Name) or (isinstance(node, ast.Constant) and type(node.value) in (int, float)):
        return
    else:
        found = ast.unparse(node) if isinstance(node, ast.expr) else type(node).__name__
        raise NetworkError(
            f"formula {text!r}: {found!r} is not allowed; "
            "use numbers, names of properties, + - * / **, parentheses, sqrt, exp and log"
        )
    for part in parts:
        _check(part, text)


def _names(node: ast.expr) -> list[str]:
    if isinstance(node, ast.Name):
        return [node.id]
    if isinstance(node, ast.BinOp):
        return _names(node.left) + _names(node.right)
    if isinstance(node, ast.UnaryOp):
        return _names(node.operand)
    return _names(node.args[0]) if isinstance(node, ast.Call) else []


def _evaluate(node: ast.expr, values: Mapping[str, Array | float]) -> Array:
    if isinstance(node, ast.Name):
        return np.asarray(values[node.id], float)
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](_evaluate(node.left, values), _evaluate(node.right, values))
    if isinstance(node, ast.UnaryOp):
        inner = _evaluate(node.operand, values)
        return -inner if isinstance(node.op, ast.USub) else inner
    if isinstance(node, ast.Call):
        assert isinstance(node.func, ast.Name)
        return FUNCTIONS[node.func.id](_evaluate(node.args[0], values))
    assert isinstance(node, ast.Constant)
    return np.asarray(node.value, float)


def _times(node: ast.expr, factor: float) -> ast.expr:
    return node if factor == 1 else ast.BinOp(node, ast.Mult(), ast.Constant(factor))


def _substitute(node: ast.expr, trees: Mapping[str, ast.expr]) -> ast.expr:
    if isinstance(node, ast.Name):
        return trees.get(node.id, node)
    if isinstance(node, ast.BinOp):
        return ast.BinOp(_substitute(node.left, trees), node.op, _substitute(node.right, trees))
    if isinstance(node, ast.UnaryOp):
        return ast.UnaryOp(node.op, _substitute(node.operand, trees))
    if isinstance(node, ast.Call):
        return ast.Call(node.func, [_substitute(node.args[0], trees)], [])
    return node


def _undo(node: ast.expr, name: str, others: Mapping[str, Array | float]) -> tuple[ast.expr, Step]:
    """One step from the root towards the variable: (the branch with it, value -> (value there, slope))."""
    if isinstance(node, ast.UnaryOp):
        sign = -1.0 if isinstance(node.op, ast.USub) else 1.0
        return node.operand, lambda y: (sign * y, np.asarray(sign))
    if isinstance(node, ast.Call):
        assert isinstance(node.func, ast.Name)
        return node.args[0], _UNDO_FUNCTION[node.func.id]
    assert isinstance(node, ast.BinOp)
    on_left = name in _names(node.left)
    other = _evaluate(node.right if on_left else node.left, others)
    return (node.left if on_left else node.right), _undo_operator(node.op, other, on_left)


_UNDO_FUNCTION: Mapping[str, Step] = {
    "sqrt": lambda y: (np.where(y >= 0, y * y, np.nan), 2 * y),
    "exp": lambda y: (np.log(y), 1 / y),
    "log": lambda y: (np.exp(y), np.exp(y)),
}


def _undo_operator(op: ast.operator, other: Array, on_left: bool) -> Step:
    one = np.asarray(1.0)
    if isinstance(op, ast.Add):
        return lambda y: (y - other, one)
    if isinstance(op, ast.Sub):
        return (lambda y: (y + other, one)) if on_left else (lambda y: (other - y, one))
    if isinstance(op, ast.Mult):
        return lambda y: (y / other, 1 / other)
    if isinstance(op, ast.Div):
        return (lambda y: (y * other, other)) if on_left else (lambda y: (other / y, other / (y * y)))
    # a power with a number as its exponent: the positive root
    return lambda y: (np.power(y, 1 / other), np.power(y, 1 / other - 1) / other)
