"""A store of a million recordings is asked as fast as one of 100,000: by indices and not by scans.

Filling it takes minutes and 8 GB, so that it is done only where PALPATE_BENCH_MILLION is set.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import pytest

from benchmarks.made_up import fill, new_store
from palpate.store.filters import Filter
from palpate.store.listing import Page, list_recordings
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties

Fixture = Any  # pytest-benchmark's fixture
FEW = 100_000
MANY = 10 * FEW
FACTOR = 3
"""How much longer the larger store may take."""
WANTED = Filter(gripper="gripper3", property="mass")


class Stores(NamedTuple):
    """Two stores of the same kind of recordings."""

    few: Store
    many: Store


@pytest.fixture(scope="module")
def stores(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stores]:
    """A store of 100,000 and one of a million recordings."""
    if not os.environ.get("PALPATE_BENCH_MILLION"):
        pytest.skip("PALPATE_BENCH_MILLION is not set: a million recordings take minutes and 8 GB")
    folder: Path = tmp_path_factory.mktemp("million")
    with ExitStack() as stack:
        # pytest keeps what tests leave
        stack.callback(shutil.rmtree, folder)
        stores = Stores(*(stack.enter_context(new_store("sqlite", folder / name)) for name in Stores._fields))
        fill(stores.few, FEW)
        fill(stores.many, MANY)
        yield stores


def measure(benchmark: Fixture, stores: Stores, what: str, ask: Callable[[Store], Page]) -> None:
    """Time the larger store; its target comes from the smaller one in the same run."""
    taken = []
    for _ in range(100):
        start = perf_counter()
        ask(stores.few)
        taken.append(perf_counter() - start)
    benchmark.extra_info.update(what=f"store, {what} of 1,000,000", target_s=FACTOR * median(taken))
    found = benchmark.pedantic(ask, (stores.many,), rounds=100, warmup_rounds=5)
    assert len(found.rows) == 50


def test_list(benchmark: Fixture, stores: Stores) -> None:
    """The last 50."""
    measure(benchmark, stores, "list of 50", list_recordings)


def test_filter(benchmark: Fixture, stores: Stores) -> None:
    """50 by gripper and property."""
    measure(benchmark, stores, "50 by gripper, property", lambda store: list_recordings(store, WANTED))


def test_table(benchmark: Fixture, stores: Stores) -> None:
    """Objects x properties, for which every value has to be read."""
    benchmark.extra_info.update(what="store, objects x properties of 1,000,000")
    cells = benchmark.pedantic(objects_by_properties, (stores.many,), rounds=3)
    assert sum(cell.count for cell in cells) == MANY
