"""Types of columns whose values are looked at when they are read.

In an SQLite file that was changed by other hands a cell may hold anything, whatever its column says, and SQLAlchemy
gives it as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import sqlalchemy
from sqlalchemy import Dialect, TypeDecorator

from palpate.store.errors import DamagedError

__all__ = ["BigInteger", "Boolean", "Float", "Integer", "LargeBinary", "String", "Text"]

MOST = 40


class Cell(TypeDecorator[Any]):
    """A type that gives values of some types of Python, or None, and nothing else."""

    impl: Any = sqlalchemy.String
    held: ClassVar[tuple[type, ...]] = ()

    def result_processor(self, dialect: Dialect, coltype: object) -> Callable[[Any], Any] | None:
        """What looks at each value; databases that keep to the types of columns need none of it."""
        if dialect.name != "sqlite":
            return super().result_processor(dialect, coltype)
        held = self.held

        def process(value: Any) -> Any:
            if value is None or type(value) in held:
                return value
            names = " or ".join(one.__name__ for one in held)
            raise DamagedError(f"a cell holds {repr(value)[:MOST]}, expected {names}")

        return process


class String(Cell):
    """Short text."""

    impl = sqlalchemy.String
    cache_ok = True
    held = (str,)


class Text(Cell):
    """Text."""

    impl = sqlalchemy.Text
    cache_ok = True
    held = (str,)


class LargeBinary(Cell):
    """Bytes."""

    impl = sqlalchemy.LargeBinary
    cache_ok = True
    held = (bytes,)


class Integer(Cell):
    """A whole number."""

    impl = sqlalchemy.Integer
    cache_ok = True
    held = (int,)


class BigInteger(Cell):
    """A whole number of 64 bits."""

    impl = sqlalchemy.BigInteger
    cache_ok = True
    held = (int,)


class Float(Cell):
    """A number."""

    impl = sqlalchemy.Float
    cache_ok = True
    held = (float, int)


class Boolean(Cell):
    """Whether something holds."""

    impl = sqlalchemy.Boolean
    cache_ok = True
    held = (int,)

    def result_processor(self, dialect: Dialect, coltype: object) -> Callable[[Any], Any] | None:
        """As of all types; SQLite has numbers for true and false."""
        process = super().result_processor(dialect, coltype)
        if dialect.name != "sqlite" or process is None:
            return process
        return lambda value: None if value is None else bool(process(value))
