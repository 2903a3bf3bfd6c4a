"""Many writers, and what keeps them from writing."""

import multiprocessing
import sqlite3
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from palpate.store.errors import StoreError
from palpate.store.opening import open_store
from palpate.store.records import Receipt
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.made_up import squeeze
from tests.store.places import check_services, emptied


def put_both(place: str, blobs: Path, first: int) -> list[Receipt]:
    with open_store(place, blobs) as store:
        return [store.put(squeeze(number)) for number in range(first, first + 15)]


def test_threads_write_at_once(store: Store) -> None:
    """Eight threads that put the same recordings: each is there once, new for one of them."""
    with ThreadPoolExecutor(8) as threads:
        batches = list(threads.map(lambda _: [store.put(squeeze(number)) for number in range(6)], range(8)))
    receipts = [receipt for batch in batches for receipt in batch]
    assert sum(receipt.new for receipt in receipts) == 6
    assert len({receipt.id for receipt in receipts}) == 6
    assert list(verify(store)) == []


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_processes_write_at_once(kind: str, tmp_path: Path) -> None:
    """Two processes that put overlapping recordings into a store that neither has made before."""
    check_services(kind)
    place = emptied() if kind == "postgresql" else str(tmp_path / "store.sqlite")
    blobs = tmp_path / "blobs"
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        both = pool.starmap(put_both, [(place, blobs, 0), (place, blobs, 10)])
    receipts = [receipt for batch in both for receipt in batch]
    assert sum(receipt.new for receipt in receipts) == 25
    with open_store(place, blobs) as store:
        assert list(verify(store)) == []
        assert all(store.get(receipt.id).digest == receipt.digest for receipt in receipts)


def test_a_lock_that_ends_is_waited_for(local: Store) -> None:
    """While another program holds the file for a moment, putting waits."""
    other = sqlite3.connect(str(local.engine.url.database), isolation_level=None, check_same_thread=False)
    other.execute("BEGIN IMMEDIATE")
    release = threading.Timer(0.4, other.execute, ["ROLLBACK"])
    begun = time.monotonic()
    release.start()
    assert local.put(squeeze()).new
    assert time.monotonic() - begun > 0.35
    release.join()
    other.close()


def test_a_locked_store_is_an_error_in_one_sentence(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """While another program holds the file for longer than one waits, putting is refused; later it works."""
    path = str(local.engine.url.database)
    monkeypatch.setattr("palpate.store.database.WAIT_S", 0.1)
    with open_store(path) as impatient:
        other = sqlite3.connect(path, isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(StoreError, match="database is locked; nothing was kept"):
            impatient.put(squeeze())
        other.execute("ROLLBACK")
        other.close()
        assert impatient.put(squeeze()).new


def test_a_full_disk_is_an_error_and_leaves_the_store_whole(local: Store) -> None:
    """When there is no space left, putting is refused, and what was there is still whole."""
    local.put(squeeze(0))
    with local.engine.connect() as connection:
        pages = connection.exec_driver_sql("PRAGMA page_count").scalar_one()

    def put_many() -> None:
        for number in range(1, 1000):
            with local.engine.connect() as connection:
                connection.exec_driver_sql(f"PRAGMA max_page_count = {pages}")
            local.put(squeeze(number))

    with pytest.raises(StoreError, match="full; nothing was kept"):
        put_many()
    assert list(verify(local)) == []
