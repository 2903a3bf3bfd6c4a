"""Running tasks in any executor: finished parts are kept, whatever stops the rest."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from palpate.errors import PalpateError, extra
from palpate.experiments.workers import Row, Task, single_threaded, work

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Row", "Task", "gathered", "run_tasks", "settings_of"]

PARTS, MANIFEST = "parts", "manifest.json"
MOST_BREAKS = 3
"""How often workers may die one after the other while no task gets done."""


def run_tasks(
    tasks: Sequence[Task],
    folder: str | Path,
    executor: Executor | None = None,
    told: Callable[[int, int], None] | None = None,
    *,
    settings: Mapping[str, object] | None = None,
    resume: bool = False,
) -> None:
    """Run tasks and keep the rows of each in a file of its own as soon as it is done.

    A part is written under another name and then renamed, so what is there is whole, whatever
    stops the run. Where a worker dies, what it and its companions had begun runs again.

    Parameters
    ----------
    folder
        Holds the manifest and the parts; made if it is not there.
    executor
        Any executor, such as those of `palpate.experiments.workers.executor`; tasks run one by one
        in this process where it is None.
    told
        Called with the number of tasks that are done and of all, first before any is.
    settings
        What the results depend on beside the keys, as JSON: a run is only resumed with the same.
    resume
        Whether to keep the parts that are there and do the rest.

    Raises
    ------
    PalpateError
        The folder holds parts and `resume` is not set, or those of another run; two tasks have the
        same key; pyarrow or threadpoolctl is missing; workers keep dying.
    """
    _check_keys(tasks)
    _pyarrow()  # what is not installed is told before a folder is made, which would be in the way afterwards
    with single_threaded():
        parts = _prepare(Path(folder), tasks, settings or {}, resume)
        waiting = [task for task in tasks if not (parts / f"{task.key}.parquet").exists()]
        tell = told or (lambda done, of: None)
        tell(len(tasks) - len(waiting), len(tasks))
        for task, rows in _done(tuple(waiting), executor):
            _write(parts / f"{task.key}.parquet", rows)
            waiting.remove(task)
            tell(len(tasks) - len(waiting), len(tasks))


def gathered(folder: str | Path) -> pa.Table:
    """The rows of all parts, in the order of the tasks, whatever order they were done in.

    Raises
    ------
    PalpateError
        The folder holds no run, or one that is not complete.
    """
    arrow, parquet = _pyarrow()
    folder = Path(folder)
    keys = _manifest(folder)["tasks"]
    paths = [folder / PARTS / f"{key}.parquet" for key in keys]
    missing = sum(not path.exists() for path in paths)
    if missing:
        raise PalpateError(
            f"{folder}: {missing} of {len(paths)} parts are missing, expected all of them: resume the run"
        )
    return arrow.concat_tables([parquet.read_table(path) for path in paths], promote_options="permissive")


def settings_of(folder: str | Path) -> dict[str, Any]:
    """The settings of the run in a folder; PalpateError if it holds none."""
    found: dict[str, Any] = _manifest(Path(folder))["settings"]
    return found


def _check_keys(tasks: Sequence[Task]) -> None:
    for key, count in Counter(task.key for task in tasks).items():
        if count > 1:
            raise PalpateError(f"{count} tasks have the key {key!r}, expected one")


def _prepare(folder: Path, tasks: Sequence[Task], settings: Mapping[str, object], resume: bool) -> Path:
    """Make the folder, or make sure that it is of the same run; where the parts go."""
    _pyarrow()
    keys = [task.key for task in tasks]
    digest = sha256(json.dumps([keys, settings], sort_keys=True).encode()).hexdigest()[:16]
    if (folder / MANIFEST).exists():
        if not resume:
            raise PalpateError(f"{folder} holds results already, expected another folder, or --resume to go on there")
        if _manifest(folder)["digest"] != digest:
            raise PalpateError(f"{folder} holds results of other settings, expected the same ones or another folder")
    (folder / PARTS).mkdir(parents=True, exist_ok=True)
    content = {"digest": digest, "settings": settings, "tasks": keys}
    _replace(folder / MANIFEST, json.dumps(content, indent=1).encode())
    return folder / PARTS


def _manifest(folder: Path) -> dict[str, Any]:
    path = folder / MANIFEST
    if not path.exists():
        raise PalpateError(f"{folder} holds no {MANIFEST}, expected the folder of a run")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def _done(tasks: Sequence[Task], executor: Executor | None) -> Iterator[tuple[Task, list[Row]]]:
    """Each task with its rows, as they get done."""
    if executor is None:
        for task in tasks:
            yield task, work(task)
        return
    left, breaks = list(tasks), 0
    while left:
        before = len(left)
        for task, rows in _until_broken(left, executor):
            left.remove(task)
            yield task, rows
        breaks = breaks + 1 if len(left) == before else 0
        if breaks == MOST_BREAKS:
            raise PalpateError(
                f"workers died {breaks} times before any of {len(left)} tasks was done, the first of them "
                f"{left[0].key!r}: expected memory for it, or fewer workers"
            )


def _until_broken(tasks: Sequence[Task], executor: Executor) -> Iterator[tuple[Task, list[Row]]]:
    """The tasks that get done before a worker dies, and with it all that had been handed out."""
    futures: dict[Future[list[Row]], Task] = {executor.submit(work, task): task for task in tasks}
    pending = set(futures)
    try:
        while pending:
            done, pending = wait(pending, return_when=FIRST_COMPLETED)
            for future in done:
                if not isinstance(future.exception(), BrokenExecutor):
                    yield futures[future], future.result()
    finally:
        for future in pending:
            future.cancel()


def _write(path: Path, rows: Sequence[Row]) -> None:
    arrow, parquet = _pyarrow()
    buffer = arrow.BufferOutputStream()
    parquet.write_table(arrow.Table.from_pylist(rows), buffer)
    _replace(path, buffer.getvalue().to_pybytes())


def _replace(path: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    draft = path.with_name(f".{path.name}.draft")
    draft.write_bytes(content)
    draft.replace(path)


def _pyarrow() -> tuple[ModuleType, ModuleType]:
    """pyarrow and its part for Parquet, imported when first needed."""
    try:
        import pyarrow as arrow
        from pyarrow import parquet
    except ImportError as error:
        raise PalpateError(
            f"experiments keep their tables with pyarrow, which is not installed: {extra('reproduce')}"
        ) from error
    return arrow, parquet
