"""What `palpate store import` needs of memory and time for an archive of 100,000 recordings."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from benchmarks.made_up import fill, new_store
from palpate.store.archive import export_archive
from palpate.store.opening import open_store

Fixture = Any  # pytest-benchmark's fixture
COUNT = int(os.environ.get("PALPATE_BENCH_IMPORT", "100000"))
TARGET_MB = 500.0
# what a process is told of its children covers the moment before they begin, as large as the parent; this does not
PROGRAM = """
import runpy, sys
try:
    runpy.run_module("palpate", run_name="__main__")
finally:
    lines = open("/proc/self/status").read().splitlines()
    peak_kb = next(line.split()[1] for line in lines if line.startswith("VmHWM"))
    open(".peak", "w").write(peak_kb)
"""


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """An archive of many recordings."""
    folder: Path = tmp_path_factory.mktemp("import")
    with new_store("sqlite", folder) as store:
        fill(store, COUNT)
        export_archive(store, folder / "archive")
    yield folder / "archive"
    shutil.rmtree(folder)


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="only Linux tells the peak of a process in /proc")
def test_import(benchmark: Fixture, archive: Path, tmp_path: Path) -> None:
    """The peak of memory of a process that imports, and what one recording takes."""

    def run() -> None:
        command = ["store", "import", str(archive), "--store", str(tmp_path / "store.sqlite")]
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, *command], cwd=tmp_path, check=False, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr + done.stdout

    benchmark.pedantic(run, rounds=1)
    with open_store(tmp_path / "store.sqlite") as store, store.engine.connect() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM recordings").scalar_one() == COUNT
    peak_mb = int((tmp_path / ".peak").read_text()) * 1024 / 1e6
    what = f"store import, one of {COUNT:,}"
    benchmark.extra_info.update(what=what, each=COUNT, peak_mb=peak_mb, target_mb=TARGET_MB)
