"""Threads that commit at once: each gets its own answer, and they share transactions."""

import secrets
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Barrier, Event

import pytest

from palpate.store.errors import StoreError, UnavailableError
from palpate.store.keeping_episodes import put_episode
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.together import Together
from tests.store.made_up import made_episode, squeeze

COUNT = 8


class Slow:
    """Commits slowly, so that others gather meanwhile; refuses what is negative and cannot be reached by 99."""

    def __init__(self) -> None:
        self.groups = list[Sequence[int]]()
        self.begun, self.go = Event(), Event()

    def __call__(self, items: Sequence[int]) -> list[int]:
        self.groups.append(items)
        self.begun.set()
        self.go.wait(10)
        if 99 in items:
            raise UnavailableError("away")
        if min(items) < 0:
            raise StoreError(f"{min(items)} is negative")
        return [2 * item for item in items]


def gathered(items: Sequence[int]) -> tuple[Slow, list[object]]:
    """What becomes of items that threads bring while the first one is being committed."""
    slow = Slow()
    together = Together[int, int](slow)

    def bring(item: int) -> object:
        try:
            return together.commit([item])
        except StoreError as error:
            return str(error)

    with ThreadPoolExecutor(len(items)) as threads:
        first = threads.submit(bring, items[0])
        slow.begun.wait(10)
        rest = [threads.submit(bring, item) for item in items[1:]]
        while len(together._waiting) < len(rest):
            pass
        slow.go.set()
        return slow, [one.result() for one in (first, *rest)]


def test_who_waits_is_committed_together() -> None:
    """All that waited go in one transaction, and each gets what became of its own."""
    slow, found = gathered([0, 1, 2, 3])
    assert found == [[0], [2], [4], [6]]
    assert sorted(map(len, slow.groups)) == [1, 3]


def test_what_is_refused_is_refused_alone() -> None:
    """The others of a transaction that failed are committed each by itself."""
    _, found = gathered([0, 1, -2, 3])
    assert found == [[0], [2], "-2 is negative", [6]]


def test_where_the_database_is_away_nobody_waits_twice() -> None:
    """All who were to be committed together learn it at once."""
    slow, found = gathered([0, 1, 99, 3])
    assert found == [[0], "away", "away", "away"]
    assert len(slow.groups) == 2


def test_threads_put_at_once(tmp_path: Path) -> None:
    """Each recording is there once, whoever was first; an id that is taken is refused to those who ask for it alone."""
    ready = Barrier(COUNT)
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        taken = squeeze(1000)
        store.put(taken)

        def put(number: int) -> list[bool]:
            ready.wait()
            news = [store.put(squeeze(part)).new for part in range(10)]
            with pytest.raises(StoreError, match="is that of another recording"):
                store.put(replace(squeeze(2000 + number), id=taken.id))
            news.append(store.put(squeeze(100 + number)).new)
            return news

        with ThreadPoolExecutor(COUNT) as threads:
            found = list(threads.map(put, range(COUNT)))
        assert [sum(one[part] for one in found) for part in range(11)] == [*[1] * 10, COUNT]
        digests = [squeeze(part).digest for part in (*range(10), *range(100, 100 + COUNT))]
        assert store.known(digests) == set(digests)


@pytest.mark.parametrize("store", ["postgresql"], indirect=True)
def test_what_the_database_does_not_take_is_refused_and_nobody_is_told_to_come_again(store: Store) -> None:
    """A name that its index cannot hold is wrong with one recording, and the others of its transaction are kept."""
    long = ThingRef("lab", secrets.token_hex(6000))
    ready = Barrier(COUNT)

    def put(number: int) -> str:
        ready.wait()
        try:
            # a name that was let in before names had an end
            (receipt,) = store.put_checked([replace(squeeze(number), thing=long) if number % 2 else squeeze(number)])
            return str(receipt.new)
        except StoreError as error:
            return f"{type(error).__name__}: {error}"

    with ThreadPoolExecutor(COUNT) as threads:
        found = list(threads.map(put, range(COUNT)))
    assert found[::2] == ["True"] * (COUNT // 2)
    assert all(one.startswith("StoreError: holds what the database does not take: index row") for one in found[1::2])
    with pytest.raises(StoreError, match=r"does not take: index row|200") as refused:
        put_episode(store, replace(made_episode(), thing=long))
    assert not isinstance(refused.value, UnavailableError)
