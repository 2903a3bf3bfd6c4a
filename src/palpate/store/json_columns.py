"""Conditions on columns that hold JSON or lines as text, the same for each database."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Boolean, ColumnElement, String, bindparam, literal
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.functions import FunctionElement

__all__ = ["Holds", "HoldsText", "holds_line"]

END = literal("\n")
"""Of a line."""


class Holds(FunctionElement[bool]):
    """Whether a text holds another one, letter by letter."""

    type = Boolean()
    inherit_cache = True

    def __init__(self, column: ColumnElement[str], part: ColumnElement[str]) -> None:
        super().__init__(column, part)


@compiles(Holds, "sqlite")
def _sqlite_part(element: Holds, compiler: SQLCompiler, **options: Any) -> str:
    column, part = (compiler.process(one, **options) for one in element.clauses)
    return f"(instr({column}, {part}) > 0)"


@compiles(Holds, "postgresql")
def _postgresql_part(element: Holds, compiler: SQLCompiler, **options: Any) -> str:
    column, part = (compiler.process(one, **options) for one in element.clauses)
    return f"(strpos({column}, {part}) > 0)"


class HoldsText(FunctionElement[bool]):
    """Whether a list of texts holds this one, letter by letter."""

    type = Boolean()
    inherit_cache = True

    def __init__(self, column: ColumnElement[str], text: str) -> None:
        super().__init__(column, bindparam(None, text, type_=String()))


@compiles(HoldsText, "sqlite")
def _sqlite(element: HoldsText, compiler: SQLCompiler, **options: Any) -> str:
    column, text = (compiler.process(part, **options) for part in element.clauses)
    return f"EXISTS (SELECT 1 FROM json_each({column}) AS each WHERE each.value = {text})"


@compiles(HoldsText, "postgresql")
def _postgresql(element: HoldsText, compiler: SQLCompiler, **options: Any) -> str:
    column, text = (compiler.process(part, **options) for part in element.clauses)
    return f"(CAST({column} AS jsonb) ? {text})"


def holds_line(column: ColumnElement[str], line: ColumnElement[str]) -> ColumnElement[bool]:
    """Whether one of the lines of a text is this one, letter by letter."""
    return Holds(END + column + END, END + line + END)
