"""Workers: what a task is, and the executors that tasks run in."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from threading import Thread
from typing import ParamSpec, Protocol, TypeVar

from palpate.errors import PalpateError, extra

__all__ = ["Processes", "Task", "executor", "single_threaded", "work"]

P = ParamSpec("P")
T = TypeVar("T")

Row = dict[str, object]
"""A row of a tidy table: column to a number, a text, a truth value, a list of numbers, or None."""

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


class Task(Protocol):
    """A piece of work that can be pickled and depends on nothing but itself."""

    @property
    def key(self) -> str:
        """Its name among the tasks: letters, digits, points, hyphens and underscores."""

    def run(self) -> list[Row]:
        """Do it; chance comes from seeds that the task holds."""


def work(task: Task) -> list[Row]:
    """Run a task in a worker, with one thread: sums of several would differ in their last digits."""
    _limit_threads()
    return task.run()


@contextmanager
def single_threaded() -> Iterator[None]:
    """Linear algebra with one thread here and in the processes that are begun here."""
    before = {name: os.environ.get(name) for name in THREADS}
    limits = _limit_threads()
    try:
        yield
    finally:
        limits()
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _limit_threads() -> Callable[[], None]:
    """Set this process to one thread, what is loaded later too; returns what undoes the former."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError as error:
        raise PalpateError(
            f"experiments limit threads with threadpoolctl, which is not installed: {extra('reproduce')}"
        ) from error
    os.environ.update(dict.fromkeys(THREADS, "1"))
    undo: Callable[[], None] = threadpool_limits(1).restore_original_limits
    return undo


class Processes(Executor):
    """Worker processes; where one is killed, and the pool with it, the next task begins a new pool.

    Parameters
    ----------
    workers
        How many processes.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._pool = self._begin()

    def _begin(self) -> ProcessPoolExecutor:
        # a new interpreter: a copy of this one would hold its threads' locks
        return ProcessPoolExecutor(self._workers, get_context("spawn"), _begin_worker)

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Have a worker call a function."""
        try:
            return self._pool.submit(fn, *args, **kwargs)
        except BrokenExecutor:
            self._pool.shutdown()
            self._pool = self._begin()
            return self._pool.submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the workers."""
        self._pool.shutdown(wait, cancel_futures=cancel_futures)


def _begin_worker() -> None:
    """Leave Ctrl-C, which reaches every process of a terminal, to the process that began this one; end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, name="palpate parent watch", daemon=True).start()


def _end_with_parent() -> None:
    """Wait for the end of the process that began this one, which would else wait for work for ever."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def executor(workers: int | None = None, scheduler: str | None = None) -> Iterator[Executor | None]:
    """An executor for `palpate.experiments.running.run_tasks`; its workers end with the context.

    Parameters
    ----------
    workers
        Processes on this computer; one for each of its processors where None, and none of its own
        where 1: then tasks run in the calling process.
    scheduler
        Address of a Dask scheduler, such as ``tcp://host:8786``, whose workers are used in place of
        processes; they need palpate with the same extras.

    Raises
    ------
    PalpateError
        The scheduler does not answer, or the extra `cluster` is not installed.
    """
    if scheduler is not None:
        with _cluster(scheduler) as cluster:
            yield cluster
        return
    count = workers if workers is not None else _processors()
    if count == 1:
        yield None
        return
    processes = Processes(count)
    try:
        yield processes
    finally:
        processes.shutdown(cancel_futures=True)


def _processors() -> int:
    """The processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _cluster(scheduler: str) -> Iterator[Executor]:
    try:
        from distributed import Client
    except ImportError as error:
        raise PalpateError(f"a Dask scheduler needs distributed, which is not installed: {extra('cluster')}") from error
    try:
        client = Client(scheduler, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise PalpateError(f"no Dask scheduler answers at {scheduler}: {error}") from error
    with client:
        found: Executor = client.get_executor()
        yield found
