"""Programs that are killed while they record: nothing that was acknowledged is lost, nothing is seen in half."""

import subprocess
import sys
from pathlib import Path

import pytest

from palpate.recording.spool import KILLED, Spool
from palpate.store.entries import FailedEntry, Value
from palpate.store.records import Recording

KILLS = 200

PROGRAM = """
import os, random, signal, sys, time
from pathlib import Path
from palpate.recording import Outcome, Spool, current_recording, record
from palpate.store.records import ThingRef

def measure(folder):
    @record("weighing", thing=ThingRef("ycb", "025_mug"), spool=Spool(folder, sync=False))
    def weigh(number):
        print("weighing", number)
        current_recording().series("scale", load=[float(number)] * 50, units={"load": "g"})
        current_recording().file("note.txt", "x" * 5000)
        return Outcome.normal("mass", float(number), unit="g")

    with open(folder / "acknowledged", "ab", buffering=0) as acknowledged:
        number = 0
        while True:
            weigh(number)
            acknowledged.write(b".")
            number += 1

chance = random.Random(7)
for attempt in range(int(sys.argv[2])):
    folder = Path(sys.argv[1]) / str(attempt)
    folder.mkdir()
    child = os.fork()
    if not child:
        measure(folder)
    # half of them while the program begins, half of them later
    end = time.monotonic() + 10.0 * (attempt % 2)
    while not (folder / "acknowledged").exists() and time.monotonic() < end:
        time.sleep(0.001)
    time.sleep(chance.uniform(0.0, 0.015))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither fork nor SIGKILL")
def test_a_kill_at_any_instant_loses_nothing(tmp_path: Path) -> None:
    """Killed at 200 random instants: all acknowledged recordings are whole, and one remainder at most is recovered."""
    command = [sys.executable, "-c", PROGRAM, str(tmp_path), str(KILLS)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    remainders = 0
    for attempt in range(KILLS):
        spool = Spool(tmp_path / str(attempt), sync=False)
        told = spool.folder / "acknowledged"
        acknowledged = told.stat().st_size if told.exists() else 0
        whole = [spool.read(name) for name in spool.waiting()]
        # one may have been whole, and its program killed before it could say so
        assert len(whole) in (acknowledged, acknowledged + 1)
        assert sorted(values_of(whole)) == [float(number) for number in range(len(whole))]
        remainders += check_remainder(spool, len(whole))
        assert spool.unfinished() == {}
    assert remainders


def values_of(recordings: list[Recording]) -> list[float]:
    return [entry.value for one in recordings for entry in one.entries if isinstance(entry, Value)]


def check_remainder(spool: Spool, number: int) -> int:
    """How many were recovered; one holds what was there when the program was killed, and nothing else."""
    recovered = [found for _, found in spool.recover()]
    assert len(recovered) <= 1
    for found in recovered:
        assert isinstance(found, Recording)
        result, failed = Value("mass", float(number), None, "g"), FailedEntry(KILLED)
        assert found.entries in ((failed,), (result, failed), (result,))
        assert values_of([found]) == [result.value] * (len(found.entries) - found.entries.count(failed))
        assert all((channel.values == number).all() for series in found.series for channel in series.channels)
    return len(recovered)
