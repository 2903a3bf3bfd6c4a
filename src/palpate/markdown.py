"""Tables and texts in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isnan

__all__ = ["Cell", "Markdown", "cell", "table"]

Cell = str | float | None
"""What stands in a table."""
SPECIAL = "\\`*_[]<>|#&~$!"


class Markdown(str):
    """A text that is Markdown already, and stands in a table as it is."""

    __slots__ = ()


def cell(text: str) -> str:
    r"""A text as it stands in a table, in one line and with nothing in it that Markdown would act on.

    Examples
    --------
    >>> cell("a|b")
    'a\\|b'
    """
    return "".join(f"\\{letter}" if letter in SPECIAL else letter for letter in " ".join(text.split()))


def table(columns: Sequence[str], rows: Iterable[Sequence[Cell]], digits: int = 3, most: int | None = None) -> str:
    r"""A table; numbers stand to the right, and what is missing is a dash.

    Parameters
    ----------
    columns
        Their heads, in Markdown.
    rows
        A cell for each column.
    digits
        Decimals of numbers that are not whole.
    most
        How many rows are shown; the last line then says how many more there are. All, unless given.

    Examples
    --------
    >>> print(table(["method", "bits"], [["greedy", 1.25], ["a|b", None], [Markdown("**all**"), 3]], most=2))
    | method | bits |
    | --- | ---: |
    | greedy | 1.250 |
    | a\|b | - |
    | and 1 more |  |
    """
    found = [list(row) for row in rows]
    right = [any(isinstance(row[i], int | float) for row in found) for i in range(len(columns))]
    lines = [list(columns), ["---:" if number else "---" for number in right]]
    lines += [[_text(each, digits) for each in row] for row in found[:most]]
    if most is not None and most < len(found):
        lines.append([f"and {len(found) - most} more", *[""] * (len(columns) - 1)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _text(found: Cell, digits: int) -> str:
    if found is None or (isinstance(found, float) and isnan(found)):
        return "-"
    if isinstance(found, Markdown):
        return found
    return f"{found:.{digits}f}" if isinstance(found, float) else cell(str(found))
