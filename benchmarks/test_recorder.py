"""What `@record` adds to a call, without and with waiting for the disk.

At least the lock, the folder and its files must be made, written and renamed, which `benchmarks.least` does by bare
calls of the system in the same run. The rest of the own cost is what a store asks for: the checks, the digest, and the
lines of the journal.
"""

from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import pytest

from benchmarks.least import LeastSpool
from palpate.recording import Outcome, Spool, current_recording, record
from palpate.store.entries import Entry
from palpate.store.records import ThingRef

Fixture = Any  # pytest-benchmark's fixture
TARGET_S = 0.3e-3
MUG = ThingRef("ycb", "025_mug")
SIGNALS = dict(zip(("position", "current", "force"), np.random.default_rng(0).normal(size=(3, 150)), strict=True))
COUNT = 300


def measuring(spool: Spool, *, signals: bool) -> Callable[[], Entry]:
    """A measurement that takes no time."""

    @record("squeezing", thing=MUG, spool=spool)
    def squeeze() -> Entry:
        if signals:
            units = {"position": "mm", "current": "A", "force": "N"}
            current_recording().series("gripper", rate_hz=100.0, units=units, **SIGNALS)
        return Outcome.normal("elasticity", 42.0, sd=10.0, unit="kPa")

    return squeeze


def written(folder: Path) -> dict[str, bytes]:
    """The files of a recording."""
    (recording,) = (folder / "waiting").iterdir()
    return {path.name: path.read_bytes() for path in recording.iterdir()}


@pytest.mark.parametrize("sync", [False, True], ids=["", "fsync"])
@pytest.mark.parametrize("signals", [False, True], ids=["own", "signals"])
def test_call(benchmark: Fixture, tmp_path: Path, sync: bool, signals: bool) -> None:
    """One call of a decorated function that does nothing itself, or keeps three arrays of 150 samples."""
    measuring(Spool(tmp_path / "once", sync=False), signals=signals)()
    least = LeastSpool(tmp_path / "least", written(tmp_path / "once"), sync=sync)
    kept = "3 channels" if signals else "nothing kept"
    what = f"@record, {kept}, {'with' if sync else 'no'} fsync"
    spool = Spool(tmp_path / "spool", sync=sync)
    call = measuring(spool, signals=signals)
    taken = list[float]()
    # in turn, as other programs on the machine come and go
    benchmark.pedantic(call, setup=lambda: taken.append(least.seconds(len(taken))), rounds=COUNT)
    assert len(spool.waiting()) == COUNT
    benchmark.extra_info.update(what=what, least_s=median(taken))
    if not (sync or signals):
        benchmark.extra_info["target_s"] = TARGET_S
