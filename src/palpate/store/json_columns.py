"""Conditions on columns that hold JSON or lines as text, the same for each database."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Boolean, ColumnElement, String, bindparam
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.functions import FunctionElement

__all__ = ["Holds", "HoldsText", "JsonText", "Tells"]


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


class Tells(FunctionElement[bool]):
    """Whether a line of the audit tells this, as JSON, of a field of this kind: in one item, not in parts of several.

    What only looks like an item, within what somebody has said, is none. A line that is damaged tells nothing.
    """

    type = Boolean()
    inherit_cache = True

    def __init__(self, line: ColumnElement[str], kind: str, after: ColumnElement[str]) -> None:
        super().__init__(line, bindparam(None, kind, type_=String()), after)


@compiles(Tells, "sqlite")
def _sqlite_tells(element: Tells, compiler: SQLCompiler, **options: Any) -> str:
    line, kind, after = (compiler.process(one, **options) for one in element.clauses)
    is_told = f"json_extract(item.value, '$.field[0]') = {kind} AND item.value -> '$.after' = {after}"
    told = f"EXISTS (SELECT 1 FROM json_each({line}) AS item WHERE item.type = 'object' AND {is_told})"
    # few lines hold the text at all, and only these are taken apart
    return f"(CASE WHEN instr({line}, {after}) > 0 AND json_valid({line}) THEN {told} ELSE 0 END)"


@compiles(Tells, "postgresql")
def _postgresql_tells(element: Tells, compiler: SQLCompiler, **options: Any) -> str:
    line, kind, after = (compiler.process(one, **options) for one in element.clauses)
    is_told = f"item -> 'field' ->> 0 = {kind} AND item -> 'after' = CAST({after} AS jsonb)"
    told = f"EXISTS (SELECT 1 FROM jsonb_array_elements(CAST({line} AS jsonb)) AS item WHERE {is_told})"
    return f"(CASE WHEN strpos({line}, {after}) > 0 AND left({line}, 1) = '[' THEN {told} ELSE false END)"


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
