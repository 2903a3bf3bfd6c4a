"""A bar that says how far something is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from palpate.cli.terminal import console

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

__all__ = ["bar", "timed"]


@contextmanager
def bar(doing: str) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left; it is told how many are done, and of how many.

    Parameters
    ----------
    doing
        What stands before it.
    """
    screen = console()
    # where it is no terminal, a bar that vanishes would leave an empty line
    with timed(screen) as progress:
        task = progress.add_task(doing, total=None)
        yield lambda done, of: progress.update(task, completed=done, total=of)


def timed(screen: Console, *, redirect_stdout: bool = True) -> Progress:
    """A bar with the time left, which vanishes when it is done; nothing where the screen is no terminal.

    Parameters
    ----------
    redirect_stdout
        Whether what is printed meanwhile goes above the bar.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(
        *columns, console=screen, transient=True, redirect_stdout=redirect_stdout, disable=not screen.is_terminal
    )
