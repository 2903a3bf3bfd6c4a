"""Programs that are killed while they send: each recording is in the spool or in the store, whole."""

import subprocess
import sys
from pathlib import Path

import pytest

from palpate.recording.spool import Spool
from palpate.recording.uploading import upload
from palpate.store.opening import open_store
from tests.store.importing.invented import squeeze

KILLS, RECORDINGS = 30, 60

PROGRAM = """
import os, random, signal, sys, time
from palpate.recording import Spool, upload
from palpate.store.opening import open_store

chance = random.Random(11)
for _ in range(int(sys.argv[3])):
    child = os.fork()
    if not child:
        with open_store(sys.argv[2], durable=False) as store:
            for sent in upload(Spool(sys.argv[1], sync=False), store):
                pass
        os._exit(0)
    time.sleep(chance.uniform(0.005, 0.1))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither fork nor SIGKILL")
def test_a_kill_while_sending_loses_nothing(tmp_path: Path) -> None:
    """After 30 kills while sending, sending once more leaves each recording in the store, once and whole."""
    spool, place = Spool(tmp_path / "spool", sync=False), tmp_path / "store.sqlite"
    moment = squeeze().recorded_at
    digests = []
    for number in range(RECORDINGS):
        recording = squeeze(recorded_at=moment.replace(minute=number))
        digests.append(recording.digest)
        spool.add(recording)
    command = [sys.executable, "-c", PROGRAM, str(spool.folder), str(place), str(KILLS)]
    subprocess.run(command, check=True)
    with open_store(place) as store:
        before = set(digests) - {spool.read(name).digest for name in spool.waiting()}
        assert {store.get(digest).digest for digest in before} == before
        list(upload(spool, store))
        assert [store.get(digest).digest for digest in digests] == digests
    assert spool.waiting() == []
