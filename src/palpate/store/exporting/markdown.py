"""Tables and texts in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

__all__ = ["cell", "markdown_table"]

SPECIAL = "\\`*_[]<>|#&~$!"


def cell(value: object) -> str:
    r"""A value as it stands in a table, in one line and with nothing in it that Markdown would act on.

    Examples
    --------
    >>> cell("a|b")
    'a\\|b'
    >>> cell(None)
    ''
    """
    text = "" if value is None else " ".join(str(value).split())
    return "".join(f"\\{letter}" if letter in SPECIAL else letter for letter in text)


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[object]], most: int | None = None) -> str:
    """A table; where there are more than `most` rows, the last says how many are not shown."""
    found = list(rows)
    shown = found if most is None else found[:most]
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    lines += [f"| {' | '.join(cell(value) for value in row)} |" for row in shown]
    if len(shown) < len(found):
        rest = [f"and {len(found) - len(shown)} more", *[""] * (len(head) - 1)]
        lines.append(f"| {' | '.join(rest)} |")
    return "\n".join(lines)
