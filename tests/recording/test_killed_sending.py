"""Programs that are killed while they send: each recording is in the spool or in the store, whole."""

from pathlib import Path

from palpate.recording.spool import Spool
from palpate.recording.uploading import upload
from palpate.store.opening import open_store
from tests.killing import kill_again_and_again, needs_sigkill
from tests.store.importing.invented import squeeze

RECORDINGS = 60
IMPORTS = """
from palpate.recording import Spool, upload
from palpate.store.opening import open_store
"""
SEND = """
with open_store(place, durable=False) as store:
    for sent in upload(Spool(spool, sync=False), store):
        pass
"""


@needs_sigkill
def test_a_kill_while_sending_loses_nothing(tmp_path: Path) -> None:
    """After many kills while sending, sending once more leaves each recording in the store, once and whole."""
    spool, place = Spool(tmp_path / "spool", sync=False), tmp_path / "store.sqlite"
    moment = squeeze().recorded_at
    digests = []
    for number in range(RECORDINGS):
        recording = squeeze(recorded_at=moment.replace(minute=number))
        digests.append(recording.digest)
        spool.add(recording)
    kill_again_and_again(IMPORTS, SEND, {"spool": spool.folder, "place": place}, longest_s=0.1)
    with open_store(place) as store:
        before = set(digests) - {spool.read(name).digest for name in spool.waiting()}
        assert {store.get(digest).digest for digest in before} == before
        list(upload(spool, store))
        assert [store.get(digest).digest for digest in digests] == digests
    assert spool.waiting() == []
