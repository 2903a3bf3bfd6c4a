"""A bar that says how far something is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from palpate.cli.terminal import console

__all__ = ["bar"]


@contextmanager
def bar(doing: str) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left; it is told how many are done, and of how many.

    Parameters
    ----------
    doing
        What stands before it.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    screen = console()
    # where it is no terminal, a bar that vanishes would leave an empty line
    with Progress(*columns, console=screen, transient=True, disable=not screen.is_terminal) as progress:
        task = progress.add_task(doing, total=None)
        yield lambda done, of: progress.update(task, completed=done, total=of)
