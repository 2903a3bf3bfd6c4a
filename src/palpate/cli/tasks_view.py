"""Tasks of an experiment, run with a bar in the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from palpate.cli.terminal import console
from palpate.experiments.running import Task, run_tasks
from palpate.experiments.workers import executor

__all__ = ["run_shown"]


def run_shown(
    tasks: Sequence[Task],
    folder: Path,
    *,
    doing: str,
    settings: Mapping[str, object],
    workers: int | None,
    scheduler: str | None,
    resume: bool,
) -> None:
    """Run tasks as `palpate.experiments.running.run_tasks` does, and show how far it is.

    Parameters
    ----------
    doing
        What stands before the bar.
    """
    try:
        with executor(workers, scheduler) as found, _bar(doing) as told:
            run_tasks(tasks, folder, found, told, settings=settings, resume=resume)
    except KeyboardInterrupt:
        print(f"What is done is kept in {folder}: the same command with --resume goes on from there.")
        raise


@contextmanager
def _bar(doing: str) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    screen = console()
    # where it is no terminal, a bar that vanishes would leave an empty line
    with Progress(*columns, console=screen, transient=True, disable=not screen.is_terminal) as progress:
        bar = progress.add_task(doing, total=None)
        yield lambda done, of: progress.update(bar, completed=done, total=of)
