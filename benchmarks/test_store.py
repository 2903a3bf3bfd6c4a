"""Recordings put, one by one and in batches.

At least each must be hashed (SHA-256 of 3.6 kB: 2 us), compressed (zstd: 8 us), described (0.8 kB of JSON: 6 us) and
inserted (3 rows, 10 entries of indices: 20 us in a batch; alone 12 pages of 16 KiB go into the log and later into the
file: 220 us, and the disk has to be waited for where synchronous=FULL). `benchmarks.least` measures all but the JSON
in the same run.
"""

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from benchmarks.least import BareCommits, LeastPuts
from benchmarks.made_up import BATCH, new_store, recordings
from palpate.store.records import Recording
from palpate.store.store import Store
from tests.store.places import POSTGRESQL

Fixture = Any  # pytest-benchmark's fixture
SINGLE, ROUNDS = 500, 10
"""Recordings in a round of single puts, and rounds: 5,000 recordings."""


def in_rounds(
    benchmark: Fixture,
    store: Store,
    put: Callable[[list[Recording]], object],
    beside: Mapping[str, Callable[[list[Recording]], float]],
    *,
    count: int,
    rounds: int = ROUNDS,
) -> dict[str, float]:
    """Time rounds of new recordings, and before each what it is compared with; the medians of that [s]."""
    first, others = iter(range(0, 10**7, count)), {name: list[float]() for name in beside}
    last = list[Recording]()

    def setup() -> tuple[tuple[list[Recording]], dict[str, Any]]:
        made = recordings(next(first), count)
        for name, seconds in beside.items():
            # its digest is taken once, so that of the others must be of a copy
            others[name].append(seconds([replace(one) for one in made]))
        last[:] = [replace(one) for one in made]
        return (made,), {}

    benchmark.pedantic(put, setup=setup, rounds=rounds)
    digests = {one.digest for one in last}
    assert len(digests) == count
    assert store.known(digests) == digests
    return {name: median(found) for name, found in others.items()}


@pytest.mark.parametrize("durable", [True, False], ids=["FULL", "NORMAL"])
def test_one_transaction_each(benchmark: Fixture, tmp_path: Path, durable: bool) -> None:
    """Recordings put one by one; FULL is compared with bare commits in the same run."""
    benchmark.extra_info.update(what=f"store, one put, synchronous={'FULL' if durable else 'NORMAL'}", each=SINGLE)
    with ExitStack() as stack:
        store = stack.enter_context(new_store("sqlite", tmp_path, durable=durable))
        store.put_many(recordings(10**7, 5))
        least = LeastPuts(stack, tmp_path, at_once=1, durable=durable)
        bare = BareCommits(stack, tmp_path / "bare.sqlite")
        beside = {"least": least.seconds, "bare": bare.seconds}
        found = in_rounds(benchmark, store, lambda made: [store.put(one) for one in made], beside, count=SINGLE)
    target = found["bare"] / 0.4 if durable else 1 / 2000
    benchmark.extra_info.update(target_s=target, least_s=found["least"])


def test_one_transaction_each_on_postgresql(benchmark: Fixture, tmp_path: Path) -> None:
    """Recordings put one by one into PostgreSQL, compared with bare commits in the same run."""
    benchmark.extra_info.update(what="store, one put, PostgreSQL", each=SINGLE)
    with ExitStack() as stack:
        store = stack.enter_context(new_store("postgresql", tmp_path))
        store.put_many(recordings(10**7, 5))
        assert POSTGRESQL is not None
        beside = {"bare": BareCommits(stack, POSTGRESQL).seconds}
        found = in_rounds(
            benchmark, store, lambda made: [store.put(one) for one in made], beside, count=SINGLE, rounds=4
        )
    benchmark.extra_info["least_s"] = found["bare"]


def test_batches(benchmark: Fixture, tmp_path: Path) -> None:
    """Recordings put a thousand at a time."""
    benchmark.extra_info.update(what="store, one of a batch", each=BATCH, target_s=1 / 10_000)
    with ExitStack() as stack:
        store = stack.enter_context(new_store("sqlite", tmp_path))
        least = LeastPuts(stack, tmp_path, at_once=BATCH, durable=False)
        found = in_rounds(benchmark, store, store.put_many, {"least": least.seconds}, count=BATCH)
    benchmark.extra_info["least_s"] = found["least"]


def test_batches_on_postgresql(benchmark: Fixture, tmp_path: Path) -> None:
    """Recordings put into PostgreSQL a thousand at a time."""
    benchmark.extra_info.update(what="store, one of a batch, PostgreSQL", each=BATCH)
    with new_store("postgresql", tmp_path) as store:
        in_rounds(benchmark, store, store.put_many, {}, count=BATCH)
