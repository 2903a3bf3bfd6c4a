"""Tasks of an experiment, run with a bar in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from palpate.cli.progress_view import bar
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
        with executor(workers, scheduler) as found, bar(doing) as told:
            run_tasks(tasks, folder, found, told, settings=settings, resume=resume)
    except KeyboardInterrupt:
        print(f"What is done is kept in {folder}: the same command with --resume goes on from there.")
        raise
