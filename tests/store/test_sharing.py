"""Many writers, and what keeps them from writing."""

import multiprocessing
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import select

from palpate.store import schema
from palpate.store.describing import change_thing
from palpate.store.errors import StoreError
from palpate.store.merging import merge_things
from palpate.store.opening import open_store
from palpate.store.records import Receipt, ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing, find_thing
from palpate.store.verifying import verify
from tests.store.made_up import squeeze
from tests.store.places import check_services, emptied

THINGS = ThingRef("made_up", "a"), ThingRef("made_up", "b")


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


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Store]:
    check_services("postgresql")
    with open_store(emptied(), tmp_path / "blobs") as store:
        store.put_many([squeeze(number, thing=thing) for number, thing in enumerate(THINGS)])
        yield store


def test_a_recording_is_put_while_its_object_is_changed(server: Store) -> None:
    """Whoever describes an object keeps nobody from recording it."""

    def edit(thing: Thing) -> Thing:
        with ThreadPoolExecutor(1) as threads:
            assert threads.submit(server.put, squeeze(9, thing=THINGS[0])).result(10).new
        return thing.described(maker="somebody")

    change_thing(server, THINGS[0], edit)
    assert find_thing(server, "made_up/a").recordings == 2


@pytest.mark.parametrize(
    "act",
    [
        lambda store: merge_things(store, THINGS[1], THINGS[0]),
        lambda store: merge_things(store, THINGS[0], THINGS[1]),
        lambda store: store.put_many(
            [squeeze(9, thing=replace(thing, maker="somebody")) for thing in reversed(THINGS)]
        ),
    ],
)
def test_who_needs_two_objects_takes_them_in_one_order(server: Store, act: Callable[[Store], object]) -> None:
    """So nobody waits for the second one of somebody who waits for the first one."""
    columns = schema.things.c
    with ThreadPoolExecutor(1) as threads:
        with server.engine.begin() as connection:
            for thing in THINGS:
                found = select(columns.id).where(columns.name == thing.id).with_for_update(key_share=True)
                connection.execute(found)
                if thing == THINGS[0]:
                    acting = threads.submit(act, server)
                    wait_for_a_lock(server)
        acting.result(10)


def wait_for_a_lock(store: Store) -> None:
    """Until somebody waits for the row of another transaction."""
    end = time.monotonic() + 10
    with store.engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        while not connection.exec_driver_sql("SELECT count(*) FROM pg_locks WHERE NOT granted").scalar():
            assert time.monotonic() < end, "nobody waits"
            time.sleep(0.01)
