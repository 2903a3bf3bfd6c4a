"""Tasks run in any executor: what is done is kept, and results do not depend on who did them."""

import sys
from collections.abc import Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

import pytest

from palpate import PalpateError
from palpate.experiments.running import gathered, run_tasks, settings_of
from palpate.experiments.workers import Task, executor
from tests.experiments.jobs import Deadly, Draw, Stopper

DRAWS = [Draw(number) for number in range(6)]


def rows(folder: Path, tasks: Sequence[Task] = DRAWS, workers: Executor | None = None):
    """Run in a new folder, and read the rows back."""
    run_tasks(tasks, folder, workers)
    return gathered(folder).to_pylist()


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory):
    """The rows of all tasks, run one by one in this process."""
    return rows(tmp_path_factory.mktemp("alone") / "run")


def test_rows_are_those_of_the_tasks_in_their_order(alone) -> None:
    """What is gathered is what the tasks returned, task by task."""
    assert alone == [row for task in DRAWS for row in task.run()]


@pytest.mark.parametrize("workers", [1, 2])
def test_processes_give_the_same_to_the_last_bit(alone, tmp_path: Path, workers: int) -> None:
    """The number of worker processes changes nothing."""
    with executor(workers) as processes:
        assert rows(tmp_path, workers=processes) == alone


def test_threads_give_the_same_to_the_last_bit(alone, tmp_path: Path) -> None:
    """Any executor of the standard library's kind serves."""
    with ThreadPoolExecutor(3) as threads:
        assert rows(tmp_path, workers=threads) == alone


def test_a_cluster_gives_the_same_to_the_last_bit(alone, tmp_path: Path) -> None:
    """A Dask scheduler serves too, reached by its address."""
    distributed = pytest.importorskip("distributed", reason="needs the extra palpate[cluster]")
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address=None
    )
    with cluster, executor(scheduler=cluster.scheduler_address) as workers:
        assert rows(tmp_path, workers=workers) == alone


def test_a_killed_worker_loses_nothing(alone, tmp_path: Path) -> None:
    """The pool is made anew, and what was unfinished runs again."""
    tasks: list[Task] = [*DRAWS[:3], Deadly(DRAWS[3], tmp_path / "killed"), *DRAWS[4:]]
    with executor(2) as workers:
        assert rows(tmp_path / "run", tasks, workers) == alone
    assert (tmp_path / "killed").exists()


def test_workers_that_keep_dying_end_the_run(tmp_path: Path) -> None:
    """A task that always kills its worker is an error that names it."""
    tasks: list[Task] = [Deadly(DRAWS[1], tmp_path / "killed", always=True)]
    with executor(2) as workers, pytest.raises(PalpateError, match=r"workers died 3 times .*'draw-1'"):
        run_tasks(tasks, tmp_path / "run", workers)
    assert not (tmp_path / "run" / "parts" / "draw-1.parquet").exists()


def test_an_interrupted_run_is_resumed(alone, tmp_path: Path) -> None:
    """What was done before Ctrl-C is kept, and only the rest is done when the run is resumed."""
    told: list[tuple[int, int]] = []
    with pytest.raises(KeyboardInterrupt):
        run_tasks([*DRAWS[:4], Stopper(), *DRAWS[4:]], tmp_path / "run")
    assert len(list((tmp_path / "run" / "parts").glob("*.parquet"))) == 4
    with pytest.raises(PalpateError, match="1 of 2 parts are missing"):
        _half_run(tmp_path / "half")
    run_tasks(DRAWS[:2], tmp_path / "half", told=lambda done, of: told.append((done, of)), resume=True)
    assert told == [(1, 2), (2, 2)]
    assert gathered(tmp_path / "half").to_pylist() == alone[:6]


def _half_run(folder: Path) -> None:
    """Run two tasks and lose the part of the second."""
    run_tasks(DRAWS[:2], folder)
    (folder / "parts" / "draw-1.parquet").unlink()
    gathered(folder)


def test_a_folder_with_results_is_left_alone(tmp_path: Path) -> None:
    """Without --resume nothing is mixed with what is there, and with it nothing of other settings."""
    run_tasks(DRAWS[:1], tmp_path, settings={"seed": 1})
    with pytest.raises(PalpateError, match="holds results already"):
        run_tasks(DRAWS[:1], tmp_path, settings={"seed": 1})
    with pytest.raises(PalpateError, match="of other settings"):
        run_tasks(DRAWS[:1], tmp_path, settings={"seed": 2}, resume=True)
    with pytest.raises(PalpateError, match="of other settings"):
        run_tasks(DRAWS[:2], tmp_path, settings={"seed": 1}, resume=True)
    assert settings_of(tmp_path) == {"seed": 1}


def test_tasks_of_the_same_key_are_refused(tmp_path: Path) -> None:
    """Their parts would overwrite each other."""
    with pytest.raises(PalpateError, match="2 tasks have the key 'draw-0'"):
        run_tasks([DRAWS[0], DRAWS[0]], tmp_path)


def test_no_run_is_one_sentence(tmp_path: Path) -> None:
    """A folder without a run cannot be gathered."""
    with pytest.raises(PalpateError, match="expected the folder of a run"):
        gathered(tmp_path)


@pytest.mark.parametrize("package", ["pyarrow", "threadpoolctl"])
def test_what_is_not_installed_is_told_before_a_folder_is_made(
    package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise the same command is refused after installing, as the folder would be there."""
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(PalpateError, match=rf'{package}, which is not installed: pip install "palpate\[reproduce\]"'):
        run_tasks(DRAWS, tmp_path / "run")
    assert not (tmp_path / "run").exists()
