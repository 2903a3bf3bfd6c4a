"""Many at once: nothing fails, and what was answered is kept, also by a server that is told to stop meanwhile."""

import signal
import threading
import time
from http.client import HTTPException
from pathlib import Path

import pytest

from benchmarks.load import loaded, missing
from benchmarks.serving import Asking, packages, serving
from tests.store.places import POSTGRESQL


@pytest.mark.parametrize(("kind", "workers"), [("sqlite", "2"), ("postgresql", "1")])
def test_many_upload_and_browse(tmp_path: Path, kind: str, workers: str) -> None:
    """8 that upload and 10 that browse for 5 seconds see no error, and lose nothing."""
    with serving(kind, tmp_path, "--workers", workers) as (address, token, _):
        load = loaded(address, token, uploading=8, browsing=10, seconds=5.0)
    assert load.errors == {}
    assert len(load.kept) > 20
    assert len(load.seconds["page"]) > 10
    place = tmp_path / "store.sqlite" if kind == "sqlite" else str(POSTGRESQL)
    assert missing(place, tmp_path / "blobs", load.kept) == set()


def test_a_server_that_stops_keeps_what_it_answered(tmp_path: Path) -> None:
    """Told to stop in the middle of uploads, it ends by itself; all that was answered 201 is there."""
    sent, kept = packages(0, 600), set[str]()
    with serving("sqlite", tmp_path) as (address, token, process):

        def upload(number: int) -> None:
            with Asking(address, token) as asking:
                for digest, data in sent[number::4]:
                    try:
                        status, _ = asking.put((digest, data))
                    except (HTTPException, OSError):
                        return
                    assert status == 201
                    kept.add(digest)

        clients = [threading.Thread(target=upload, args=(number,)) for number in range(4)]
        for one in clients:
            one.start()
        while len(kept) < 20:
            time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        for one in clients:
            one.join()
        assert process.wait(30) in (0, -signal.SIGTERM)
    assert 20 <= len(kept) < len(sent)
    assert missing(tmp_path / "store.sqlite", tmp_path / "blobs", kept) == set()
