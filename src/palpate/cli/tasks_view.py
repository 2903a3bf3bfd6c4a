"""Tasks of an experiment, run with a bar in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from palpate.cli.progress_view import bar
from palpate.cli.task_options import Running
from palpate.errors import plural
from palpate.experiments.running import Task, run_tasks
from palpate.experiments.workers import executor

__all__ = ["run_shown"]


def run_shown(
    tasks: Sequence[Task], folder: Path, running: Running, *, doing: str, settings: Mapping[str, object]
) -> None:
    """Run tasks as `palpate.experiments.running.run_tasks` does, and show how far it is.

    Parameters
    ----------
    doing
        What stands before the bar.
    """
    kept = 0
    try:
        with executor(running.workers, running.scheduler) as found, bar(doing) as told:

            def tell(done: int, of: int) -> None:
                nonlocal kept
                kept = done
                told(done, of)

            run_tasks(tasks, folder, found, tell, settings=settings, resume=running.resume)
    except KeyboardInterrupt:
        print(
            f"Interrupted: {kept} of {plural(len(tasks), 'task')} are done and kept in {folder}; the same command with "
            "--resume goes on from there."
        )
        raise
