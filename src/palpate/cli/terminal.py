"""The consoles: one that tables are printed on, and one for what is shown only meanwhile."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from palpate.invisible import shown

__all__ = ["ENDLESS", "bullets", "console", "error_console", "folding_table", "is_terminal", "print_whole"]

ENDLESS = 1_000_000
"""Characters in a line where nobody looks at it."""


class _Shown(Console):
    """A console on which letters that nobody sees, and that move what stands around them, are escapes."""

    def render_str(self, text: str, **options: Any) -> Text:
        """A text as it is printed and measured."""
        return super().render_str(shown(text), **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """The pieces of what is printed."""
        if isinstance(renderable, Text) and renderable.plain != (told := shown(renderable.plain)):
            renderable = renderable.copy()
            renderable.plain = told
        return super().render(renderable, options)


def console() -> Console:
    """Standard output: colours in a terminal, plain text elsewhere."""
    # where the encoding lacks a bar or a tick, a question mark is better than no table
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    return _Shown(highlight=False, emoji=False, markup=False)


def is_terminal() -> bool:
    """Whether somebody looks at standard output: what is piped or written to a file is for later."""
    return console().is_terminal


def error_console() -> Console:
    """Standard error, where it does not mix with what is printed for others to read."""
    return _Shown(stderr=True, highlight=False, emoji=False, markup=False)


def print_whole(view: RenderableType) -> None:
    """Print what is made for people: folded to the width of a terminal; in a pipe or a file a row is a line."""
    screen = console()
    if screen.is_terminal:
        screen.print(view)
        return
    screen.width = ENDLESS
    with screen.capture() as captured:
        screen.print(view)
    for line in captured.get().splitlines():
        print(line.rstrip())


def folding_table(*names: str, right: tuple[int, ...] = ()) -> Table:
    """A plain table whose cells fold where it is wider than the terminal; some columns stand at the right."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for place, name in enumerate(names):
        table.add_column(name, overflow="fold", justify="right" if place in right else "left")
    return table


def bullets(lines: Iterable[str]) -> Table:
    """Sentences one below the other, each with a dash before it; where one folds it stays to the right of the dash."""
    table = Table.grid(padding=(0, 1))
    for line in lines:
        table.add_row("-", Text(shown(line), overflow="fold"))
    return table
