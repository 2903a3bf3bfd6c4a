"""A PostgreSQL that goes away and comes back."""

import os
import shlex
import sqlite3
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from psycopg import OperationalError
from psycopg.errors import AdminShutdown
from sqlalchemy import PoolProxiedConnection

from palpate.cli import main
from palpate.store import outages
from palpate.store.archive import export_archive
from palpate.store.errors import DamagedError, UnavailableError
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.outages import LostError, patiently
from palpate.store.records import FileItem, Recording
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.made_up import squeeze
from tests.store.places import check_services, emptied

pytestmark = pytest.mark.alone

RESTART = os.environ.get("PALPATE_TEST_POSTGRESQL_RESTART")
"""A command that restarts the PostgreSQL of the tests, and ends when it answers again."""


def restart() -> None:
    assert RESTART is not None
    subprocess.run(shlex.split(RESTART), check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Store]:
    """A store in a PostgreSQL that can be restarted."""
    check_services("postgresql")
    if RESTART is None:
        pytest.skip("PALPATE_TEST_POSTGRESQL_RESTART is not set")
    with open_store(emptied(), tmp_path / "blobs") as store:
        yield store


def made(count: int) -> list[Recording]:
    return [squeeze(number, files=(FileItem("cam0", "image/png", b"%d" % number),)) for number in range(count)]


def test_a_restarted_server_is_waited_for(served: Store) -> None:
    """While a server is restarted twice, two threads put on: nothing that was acknowledged is lost."""
    stop, acknowledged = threading.Event(), list[str]()

    def put_all(first: int) -> None:
        number = first
        while not stop.is_set():
            acknowledged.append(served.put(squeeze(number)).digest)
            number += 2

    threads = [threading.Thread(target=put_all, args=(first,)) for first in (0, 1)]
    for thread in threads:
        thread.start()
    counts = [len(acknowledged)]
    for _ in range(2):
        stop.wait(0.3)
        restart()
        stop.wait(0.5)
        counts.append(len(acknowledged))
    stop.set()
    for thread in threads:
        thread.join()
    assert counts == sorted(set(counts)), "after each restart it went on"
    assert [served.get(digest).digest for digest in acknowledged] == acknowledged
    assert list(verify(served)) == []


def test_a_server_that_stops_in_the_middle_of_many_rows_is_waited_for(served: Store) -> None:
    """Its driver stumbles over the word that it stops, and says only that it is busy: what went before counts."""
    done = list[str]()

    def put() -> str:
        with served._statements.transaction() as cursor:
            cursor.execute("SELECT 1")
            if not done:
                done.append("lost")
                try:
                    raise AdminShutdown("terminating connection due to administrator command")
                except AdminShutdown:
                    raise OperationalError("cannot exit pipeline mode while busy")  # noqa: B904 - as the driver does
        return "put"

    assert patiently(put) == "put"
    assert done == ["lost"]
    assert served.put(squeeze()).new


def test_an_import_goes_on_after_a_restart(served: Store, tmp_path: Path) -> None:
    """An import during which the server is restarted ends with all recordings in the store, each once."""
    recordings = made(500)
    with open_store(tmp_path / "store.sqlite", durable=False) as local:
        local.put_many(recordings)
        export_archive(local, tmp_path / "archive")
    codes: list[object] = []
    address = served.engine.url.render_as_string(hide_password=False)
    command = ["store", "import", str(tmp_path / "archive"), "--store", address, "--blobs", str(tmp_path / "blobs")]

    def run_import() -> None:
        with pytest.raises(SystemExit) as ended:
            main(command)
        codes.append(ended.value.code)

    importing = threading.Thread(target=run_import)
    importing.start()
    # in the middle: some blobs are written, and the last ones are not
    while importing.is_alive() and len(list((tmp_path / "blobs").glob("*/*"))) < 250:
        importing.join(0.01)
    assert importing.is_alive()
    restart()
    importing.join()
    assert codes == [0]
    assert {served.get(recording.id).digest for recording in recordings} == {one.digest for one in recordings}
    assert list(verify(served)) == []


def test_a_commit_that_nobody_answered_is_safe_to_repeat(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """A server that commits and goes away before it says so is asked again, and keeps the recording once."""
    commit, lost = store.engine.dialect.do_commit, list[bool]()

    def commit_and_go_away(connection: PoolProxiedConnection) -> None:
        commit(connection)
        if not lost:
            lost.append(True)
            raise LostError("store: gone; expected a server that answers")

    monkeypatch.setattr(store.engine.dialect, "do_commit", commit_and_go_away)
    recording = squeeze()
    receipt = store.put(recording)
    assert lost
    assert (receipt.id, receipt.digest) == (recording.id, recording.digest)
    assert len(list_recordings(store).rows) == 1
    assert list(verify(store)) == []


def test_reading_says_that_the_server_went_away(served: Store) -> None:
    """Reading in the middle of which the server is restarted is one sentence, and works the next time."""
    served.put(squeeze())
    with served.engine.connect() as connection:
        restart()
        with pytest.raises(LostError, match=r"store postgresql.*expected a server that answers") as told:
            connection.exec_driver_sql("SELECT 1")
    assert "\n" not in str(told.value)
    assert len(list_recordings(served).rows) == 1


def test_a_server_that_stays_away_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where there is no server, opening is one sentence, and the password does not stand in it."""
    url = "postgresql+psycopg://lab:secret@127.0.0.1:9/measurements"
    with pytest.raises(UnavailableError, match=r"Connection refused.*expected a server that answers") as told:
        open_store(url, tmp_path)
    assert "\n" not in str(told.value)
    assert "secret" not in str(told.value)


def test_patience_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """A transaction that loses its server is done again, for so long and no longer; other errors are not waited for."""
    tries: list[int] = []

    def work() -> str:
        tries.append(len(tries))
        if len(tries) < 3:
            raise LostError("store: gone; expected a server that answers")
        return "done"

    assert patiently(work) == "done"
    assert len(tries) == 3
    monkeypatch.setattr(outages, "PATIENCE_S", 0.25)
    tries.clear()

    def never() -> str:
        tries.append(0)
        raise LostError("store: gone; expected a server that answers")

    with pytest.raises(LostError, match="gone"):
        patiently(never)
    assert len(tries) == 2


def test_a_damaged_file_is_named(tmp_path: Path) -> None:
    """A page of an SQLite file that was overwritten is an error in one sentence, wherever it is met."""
    path = tmp_path / "store.sqlite"
    with open_store(path) as store:
        store.put_many([squeeze(number) for number in range(200)])
    with sqlite3.connect(path) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        (root,) = connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'recordings'").fetchone()
    connection.close()
    content = bytearray(path.read_bytes())
    content[(root - 1) * 16384 : root * 16384] = b"x" * 16384
    path.write_bytes(content)
    with open_store(path) as store:
        with pytest.raises(DamagedError, match=r"store sqlite:.*malformed; expected the SQLite file that was written"):
            store.get(squeeze().digest)
        with pytest.raises(DamagedError, match="malformed"):
            list_recordings(store)
        faults = list(verify(store))
        assert {fault.where for fault in faults} == {"database"}
        assert any("recordings could not all be checked" in fault.what for fault in faults)
