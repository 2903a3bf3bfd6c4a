"""A disk that takes no more, played by a limit on the size of files."""

import subprocess
import sys
from pathlib import Path

import pytest

from palpate.recording.spool import KILLED, Spool
from palpate.store.entries import FailedEntry, Value

PROGRAM = """
import resource, signal, sys
from palpate.recording import Outcome, Spool, current_recording, record
from palpate.recording.errors import RecordingError

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

@record("weighing", spool=Spool(sys.argv[1], sync=False))
def weigh(lines, samples):
    for _ in range(lines):
        print("a line that goes to the log")
    current_recording().series("scale", load=[1.0] * samples)
    return Outcome.normal("mass", 1.0, unit="g")

weigh(1, 1)
resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))
try:
    weigh(*map(int, sys.argv[2:]))
except (OSError, RecordingError) as error:
    sys.stderr.write(type(error).__name__)
"""

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limit")


def run(folder: Path, lines: int, samples: int) -> tuple[str, Spool]:
    """Measure on a disk that has room for files of 4 kB; what was raised, and the spool."""
    command = [sys.executable, "-c", PROGRAM, str(folder), str(lines), str(samples)]
    done = subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    return done.stderr, Spool(folder, sync=False)


def test_samples_that_do_not_fit_are_an_error(tmp_path: Path) -> None:
    """The measurement fails where it gives the samples, and is recorded as failed."""
    raised, spool = run(tmp_path, 1, 10_000)
    assert raised == "OSError"
    first, second = (spool.read(name) for name in spool.waiting())
    failed = [one for one in (first, second) if isinstance(one.entries[0], FailedEntry)]
    assert len(failed) == 1
    assert failed[0].series == ()


def test_a_log_that_does_not_fit_is_told_at_the_end(tmp_path: Path) -> None:
    """Printing goes on; the call then says that the recording is not whole, and what is there is recovered."""
    raised, spool = run(tmp_path, 1000, 1)
    assert raised == "RecordingError"
    assert len(spool.waiting()) == 1
    ((_, found),) = spool.recover()
    assert getattr(found, "entries", None) == (Value("mass", 1.0, None, "g"), FailedEntry(KILLED))
