"""Conditions on columns that hold JSON or lines as text, the same for each database."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Boolean, ColumnElement, String, TableValuedAlias, bindparam, column
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.functions import FunctionElement

__all__ = ["Holds", "HoldsText", "JsonText", "each_text"]


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

    def __init__(self, column: ColumnElement[str], text: str | ColumnElement[str]) -> None:
        super().__init__(column, bindparam(None, text, type_=String()) if isinstance(text, str) else text)


@compiles(HoldsText, "sqlite")
def _sqlite(element: HoldsText, compiler: SQLCompiler, **options: Any) -> str:
    column, text = (compiler.process(part, **options) for part in element.clauses)
    return f"EXISTS (SELECT 1 FROM json_each({column}) AS each WHERE each.value = {text})"


@compiles(HoldsText, "postgresql")
def _postgresql(element: HoldsText, compiler: SQLCompiler, **options: Any) -> str:
    column, text = (compiler.process(part, **options) for part in element.clauses)
    return f"(CAST({column} AS jsonb) ? {text})"


class JsonText(FunctionElement[str]):
    """A text as JSON, letter by letter as `palpate.store.content.to_json` writes it."""

    type = String()
    inherit_cache = True

    def __init__(self, text: ColumnElement[str]) -> None:
        super().__init__(text)


@compiles(JsonText, "sqlite")
def _sqlite_json(element: JsonText, compiler: SQLCompiler, **options: Any) -> str:
    (text,) = (compiler.process(one, **options) for one in element.clauses)
    return f"json_quote({text})"


@compiles(JsonText, "postgresql")
def _postgresql_json(element: JsonText, compiler: SQLCompiler, **options: Any) -> str:
    (text,) = (compiler.process(one, **options) for one in element.clauses)
    return f"CAST(to_json(CAST({text} AS text)) AS text)"


class _EachText(FunctionElement[str]):
    type = String()
    name = "each_text"
    inherit_cache = True


@compiles(_EachText, "sqlite")
def _sqlite_each(element: _EachText, compiler: SQLCompiler, **options: Any) -> str:
    (column,) = (compiler.process(one, **options) for one in element.clauses)
    return f"json_each({column})"


@compiles(_EachText, "postgresql")
def _postgresql_each(element: _EachText, compiler: SQLCompiler, **options: Any) -> str:
    (column,) = (compiler.process(one, **options) for one in element.clauses)
    return f"jsonb_array_elements_text(CAST({column} AS jsonb))"


def each_text(texts: ColumnElement[str]) -> TableValuedAlias:
    """The texts of a list, as rows of one column, ``value``."""
    return _EachText(texts).table_valued(column("value", String()))
