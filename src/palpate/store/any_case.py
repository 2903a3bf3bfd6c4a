"""Texts in small letters, for what is looked for in any case: the same for each database, in all alphabets.

SQLite's own ``lower`` leaves all but the letters of English as they are, and what tells people apart relies on that.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import ColumnElement, String
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.functions import FunctionElement

__all__ = ["IN_SQLITE", "Small", "small"]

IN_SQLITE = "small_letters"
"""The name of `small` there, which each connection is given."""


def small(text: str | bytes | float | None) -> str | bytes | float | None:
    """A text in small letters; what is no text as it is."""
    return text.lower() if isinstance(text, str) else text


class Small(FunctionElement[str]):
    """A text in small letters."""

    type = String()
    inherit_cache = True

    def __init__(self, text: ColumnElement[str]) -> None:
        super().__init__(text)


@compiles(Small, "sqlite")
def _sqlite(element: Small, compiler: SQLCompiler, **options: Any) -> str:
    return f"{IN_SQLITE}({compiler.process(element.clauses, **options)})"


@compiles(Small, "postgresql")
def _postgresql(element: Small, compiler: SQLCompiler, **options: Any) -> str:
    return f"lower({compiler.process(element.clauses, **options)})"
