"""Imports that are killed, or interrupted: what was taken stays, nothing is there in part, and the next run goes on."""

import os
import random
import signal
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from palpate.store.archive import export_archive
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.importing.experiments import experiment, measurement
from tests.store.importing.test_squeezes import BARE, column_map
from tests.store.made_up import squeeze

KILLS = int(os.environ.get("PALPATE_TEST_KILLS", "6"))
"""How often an import is killed; each takes about a second."""
IMPORTER = """
import sys
from pathlib import Path
from palpate.store.importing import intake
from palpate.store.importing.formats import all_formats
from palpate.store.importing.reading_columns import read_columns
from palpate.store.opening import open_store
# small transactions, so that a kill finds some done and some not
intake.AT_ONCE = 3
given = Path(sys.argv[2])
with open_store(sys.argv[1]) as store:
    print("opened", flush=True)
    for outcome in intake.import_paths(store, [given / "given"], all_formats(read_columns(given / "columns.toml"))):
        print(outcome.fate.value, outcome.recording.digest if outcome.recording else "", flush=True)
"""
INTERRUPTED = """
import os, signal, sys
from palpate.cli import main
from palpate.store.importing import intake
intake.AT_ONCE = 10
whole = intake.import_paths
def interrupted(*arguments, **named):
    for number, outcome in enumerate(whole(*arguments, **named)):
        if number == 25:
            os.kill(os.getpid(), signal.SIGINT)
        yield outcome
intake.import_paths = interrupted
main(sys.argv[1:])
"""
ARCHIVED, LOGGED, SQUEEZED = 60, 10, 20


@pytest.fixture
def given(tmp_path: Path) -> Path:
    """A folder with an archive, an experiment and CSV files, and a column map beside it."""
    folder = tmp_path / "given"
    folder.mkdir()
    with open_store(tmp_path / "first.sqlite", durable=False) as store:
        for number in range(ARCHIVED):
            picture = FileItem("cam0.png", "image/png", str(number).encode())
            store.put(squeeze(number, files=(picture,)))
        export_archive(store, folder / "archive")
    tree = experiment(folder)
    for number in range(LOGGED):
        measurement(tree, name=f"elasticity_{number}")
    for number in range(SQUEEZED):
        (folder / f"{number}.csv").write_text(f"force\n{number}\n")
    column_map(tmp_path, BARE)
    return tmp_path


def killed_once(store: Path, given: Path, wait_s: float) -> list[str]:
    """Digests of what an import told as taken before it was killed."""
    command = [sys.executable, "-c", IMPORTER, str(store), str(given)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[3]) as importer:
        assert importer.stdout is not None
        assert importer.stdout.readline() == "opened\n"
        time.sleep(wait_s)
        importer.send_signal(signal.SIGKILL)
        lines = importer.stdout.readlines()
    return [line.split()[1] for line in lines if line.startswith("new ") and line.endswith("\n")]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_import_goes_on(given: Path, tmp_path: Path) -> None:
    """Killed at any instant, again and again: what was told as taken is there, and in the end everything is, once."""
    path, rng, taken = tmp_path / "store.sqlite", random.Random(0), set[str]()
    for _ in range(KILLS):
        taken |= set(killed_once(path, given, rng.uniform(0, 0.3)))
        with open_store(path) as store:
            assert taken <= store.known(taken)
            assert list(verify(store)) == []
    formats = all_formats(column_map(given, BARE))
    with open_store(path) as store:
        told = list(import_paths(store, [given / "given"], formats))
        assert {outcome.fate for outcome in told} <= {Fate.NEW, Fate.KNOWN}
        assert len(told) == ARCHIVED + LOGGED + SQUEEZED
        assert len(list_recordings(store, limit=1000).rows) == ARCHIVED + LOGGED + SQUEEZED
        assert [outcome.fate for outcome in import_paths(store, [given / "given"], formats)] == [Fate.KNOWN] * len(told)
        assert list(verify(store)) == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other signals")
def test_an_interrupted_import_goes_on(given: Path, tmp_path: Path) -> None:
    """Ctrl-C ends the command with one sentence and code 130; the same command takes the rest."""
    path = tmp_path / "store.sqlite"
    command = ["store", "import", str(given / "given"), "--columns", str(given / "columns.toml"), "--store", str(path)]
    ended = subprocess.run([sys.executable, "-c", INTERRUPTED, *command], capture_output=True, text=True, check=False)
    made, first, last = ended.stderr.splitlines()
    assert made.startswith("palpate: new store made at ")
    assert (ended.returncode, ended.stdout, last) == (130, "", "palpate: interrupted")
    assert first.startswith("broken off after 25 new, 0 there already")
    done = subprocess.run([sys.executable, "-m", "palpate", *command], capture_output=True, text=True, check=True)
    assert done.stdout == "60 new, 30 there already, 0 refused, 0 skipped\n"
    with open_store(path) as store:
        assert len(list_recordings(store, limit=1000).rows) == ARCHIVED + LOGGED + SQUEEZED
        assert list(verify(store)) == []


class Endless:
    """A format with as many recordings as asked for, each made when it is read."""

    def __init__(self, count: int) -> None:
        self.numbers = range(count)

    def owns(self, path: Path) -> bool:
        return True

    def count(self, path: Path) -> int:
        return len(self.numbers)

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        for number in self.numbers:
            yield Item(str(number), partial(squeeze, number, log="x" * 10_000))


def test_an_import_gathers_nothing(local: Store) -> None:
    """Four times as many recordings take no more memory."""
    peaks = []
    for count in (250, 1000):
        tracemalloc.start()
        for outcome in import_paths(local, [Path()], [Endless(count)]):
            assert outcome.fate in (Fate.NEW, Fate.KNOWN)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.3 * peaks[0]
