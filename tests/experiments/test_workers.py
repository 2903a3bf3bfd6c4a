"""Executors: processes, none, or a cluster."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from palpate import PalpateError
from palpate.experiments.workers import THREADS, Processes, executor, single_threaded


def test_one_worker_is_the_calling_process() -> None:
    """With one worker no process is begun."""
    with executor(1) as found:
        assert found is None


def test_several_workers_are_processes() -> None:
    """They are other processes, and each processor has one unless told otherwise."""
    with executor(2) as found:
        assert isinstance(found, Processes)
        assert found.submit(os.getpid).result() != os.getpid()


SCRIPT = """
import os, signal
from palpate.experiments.workers import executor
if __name__ == "__main__":
    with executor(2) as found:
        print(found.submit(os.getpid).result(), flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
"""


def test_workers_end_with_the_process_that_began_them(tmp_path: Path) -> None:
    """Even where that process is killed, none of its workers stays behind."""
    script = tmp_path / "killed.py"
    script.write_text(SCRIPT, encoding="utf-8")
    # what it prints ends only when the workers, which could print too, have ended
    done = subprocess.run([sys.executable, script], stdout=subprocess.PIPE, text=True, check=False, timeout=60)
    assert done.returncode == -signal.SIGKILL
    assert int(done.stdout) > 0


def test_a_scheduler_that_does_not_answer_is_one_sentence() -> None:
    """A wrong address of a Dask scheduler is an error of the user's."""
    pytest.importorskip("distributed", reason="needs the extra palpate[cluster]")
    with pytest.raises(PalpateError, match="no Dask scheduler answers at nowhere"), executor(scheduler="nowhere://1"):
        pass


def test_limits_of_threads_are_undone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Inside there is one thread, and afterwards the environment is as it was."""
    monkeypatch.setenv(THREADS[0], "3")
    monkeypatch.delenv(THREADS[1], raising=False)
    with single_threaded():
        assert [os.environ[name] for name in THREADS] == ["1"] * len(THREADS)
    assert os.environ[THREADS[0]] == "3"
    assert THREADS[1] not in os.environ
