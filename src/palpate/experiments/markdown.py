"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isnan

__all__ = ["Cell", "table"]

Cell = str | float | None
"""What stands in a table."""


def table(columns: Sequence[str], rows: Iterable[Sequence[Cell]], digits: int = 3) -> str:
    """A Markdown table; numbers have so many decimals and stand to the right, what is missing is a dash.

    Examples
    --------
    >>> print(table(["method", "bits"], [["greedy", 1.25], ["random", None]]))
    | method | bits |
    | --- | ---: |
    | greedy | 1.250 |
    | random | - |
    """
    found = [list(row) for row in rows]
    right = [any(isinstance(row[i], int | float) for row in found) for i in range(len(columns))]
    lines = [list(columns), ["---:" if number else "---" for number in right]]
    lines += [[_text(cell, digits) for cell in row] for row in found]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _text(cell: Cell, digits: int) -> str:
    if cell is None or (isinstance(cell, float) and isnan(cell)):
        return "-"
    return f"{cell:.{digits}f}" if isinstance(cell, float) else str(cell)
