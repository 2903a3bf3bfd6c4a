"""A disk that takes no more, played by a limit on the size of files."""

import errno
import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from palpate.recording.errors import RecordingError
from palpate.recording.outbox import Outbox
from palpate.recording.spool import KILLED, Spool
from palpate.store.entries import FailedEntry, Value
from palpate.store.episodes import StoredStep
from tests.store.made_up import made_episode

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


OUTGOING = """
import resource, signal, sys
from palpate.recording import Spool
from palpate.recording.errors import RecordingError
from palpate.recording.outbox import Outbox
from palpate.store.episodes import StoredStep
from tests.store.made_up import made_episode

def line(number, length=0):
    return StoredStep({"step": number, "action": "weigh", "note": "x" * length})

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
outbox = Outbox(Spool(sys.argv[1], sync=False))
outgoing = outbox.begin(made_episode())
outgoing.add(line(1))
resource.setrlimit(resource.RLIMIT_FSIZE, (4000, resource.RLIM_INFINITY))
try:
    outgoing.add(line(2, 10_000))
except RecordingError as error:
    sys.stderr.write(str(error).rpartition(": ")[2])
(name,) = outbox.waiting()
before = outbox.read(name)
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
outgoing.add(line(2, 10_000))
outgoing.add(line(3))
print([step.record["step"] for step in before.steps], [step.record["step"] for step in outbox.read(name).steps])
"""


def test_a_line_of_an_exploration_that_does_not_fit_leaves_nothing(tmp_path: Path) -> None:
    """What was written of it is no beginning of the next one: once there is room the exploration goes on."""
    command = [sys.executable, "-c", OUTGOING, str(tmp_path)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert done.stderr == "File too large"
    assert done.stdout == "[1] [1, 2, 3]\n"


def test_an_exploration_whose_beginning_does_not_fit_has_not_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It begins once there is room; and one that waits already is not begun again."""
    outbox, episode = Outbox(Spool(tmp_path, sync=False)), made_episode()
    with monkeypatch.context() as full:
        full.setattr(Path, "open", Mock(side_effect=OSError(errno.ENOSPC, "No space left on device")))
        with pytest.raises(RecordingError, match="No space left"):
            outbox.begin(episode)
    assert outbox.waiting() == []
    outbox.begin(episode).leave(is_sent=False)
    with pytest.raises(RecordingError, match="waits there already"):
        outbox.begin(episode)
    assert outbox.read(str(episode.id)).steps == episode.steps


@pytest.mark.parametrize("lasting", [False, True])
def test_what_a_failed_write_left_is_written_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, lasting: bool
) -> None:
    """Also where the file could not be cut at once."""
    outbox = Outbox(Spool(tmp_path, sync=False))
    outgoing = outbox.begin(made_episode())
    (name,) = outbox.waiting()
    opened = Path.open

    class Half:
        """A file that takes half of what is written."""

        def __init__(self, file: Any) -> None:
            self._file = file

        def __enter__(self) -> Any:
            return self

        def __exit__(self, *_: object) -> None:
            self._file.close()

        def __getattr__(self, what: str) -> Any:
            return getattr(self._file, what)

        def write(self, data: bytes) -> None:
            self._file.write(data[: len(data) // 2])
            raise OSError(errno.ENOSPC, "No space left on device")

        def truncate(self, size: int | None = None) -> int:
            if lasting and self._file.tell():
                raise OSError(errno.EIO, "Input/output error")
            return int(self._file.truncate(size))

    with monkeypatch.context() as full:
        full.setattr(Path, "open", lambda *path, **options: Half(opened(*path, **options)))
        with pytest.raises(RecordingError, match="cannot be written"):
            outgoing.add(StoredStep({"step": 1, "action": "weigh"}))
    assert outbox.read(name).steps == ()
    outgoing.add(StoredStep({"step": 1, "action": "knock"}))
    assert [step.record["action"] for step in outbox.read(name).steps] == ["knock"]
