"""The consoles: one that tables are printed on, and one for what is shown only meanwhile."""

from __future__ import annotations

import io
import sys

from rich.console import Console

__all__ = ["console", "error_console"]


def console() -> Console:
    """Standard output: colours in a terminal, plain text elsewhere."""
    # where the encoding lacks a bar or a tick, a question mark is better than no table
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    return Console(highlight=False, emoji=False, markup=False)


def error_console() -> Console:
    """Standard error, where it does not mix with what is printed for others to read."""
    return Console(stderr=True, highlight=False, emoji=False, markup=False)
