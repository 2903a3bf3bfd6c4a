"""The store: recordings of 150 samples of 3 channels, put and asked for on SQLite."""

import sqlite3
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.store.curves import curves_of_gripper
from palpate.store.entries import Value
from palpate.store.filters import Filter
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import Channel, Device, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties

Fixture = Any  # pytest-benchmark's fixture
SINGLE, MANY, BATCH = 500, 100_000, 1000
GRIPPERS = [Setup(gripper=Device("gripper", f"gripper{number}")) for number in range(5)]
PROPERTIES = {"elasticity": "kPa", "mass": "g", "volume": "cm^3"}
START = datetime(2024, 1, 1, tzinfo=UTC)


def recordings(first: int, count: int, samples: int = 150) -> list[Recording]:
    rng = np.random.default_rng(first)
    units = {"position": ("length", "mm"), "current": ("current", "A"), "force": ("force", "N")}
    names = list(PROPERTIES)
    made = []
    for number in range(first, first + count):
        signals = rng.normal(size=(3, samples)).cumsum(axis=1)
        channels = [
            Channel(name, quantity, unit, values, 100.0)
            for values, (name, (quantity, unit)) in zip(signals, units.items(), strict=True)
        ]
        name = names[number % 3]
        made.append(
            Recording(
                START + timedelta(seconds=number),
                "squeezing",
                ThingRef("made up", f"object{number % 60}"),
                GRIPPERS[number % 5],
                series=(Series("gripper", tuple(channels)),),
                entries=(Value(name, 40.0 + rng.normal(), 10.0, PROPERTIES[name]),),
            )
        )
    return made


@pytest.fixture(scope="module")
def full(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    """A store of 100,000 recordings."""
    with open_store(tmp_path_factory.mktemp("full") / "store.sqlite", durable=False) as store:
        for first in range(0, MANY, BATCH):
            store.put_many(recordings(first, BATCH))
        yield store


def bare_commit_s(path: Path) -> float:
    """Seconds of a bare one-row commit on the same disk."""
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute("CREATE TABLE one (row)")
    start = datetime.now(UTC)
    for _ in range(SINGLE):
        connection.execute("INSERT INTO one VALUES (1)")
    taken = datetime.now(UTC) - start
    connection.close()
    return taken.total_seconds() / SINGLE


@pytest.mark.parametrize("durable", [True, False], ids=["FULL", "NORMAL"])
def test_one_transaction_each(benchmark: Fixture, tmp_path: Path, durable: bool) -> None:
    """Recordings put one by one; FULL is compared with bare commits in the same run."""
    target = bare_commit_s(tmp_path / "bare.sqlite") / 0.4 if durable else 1 / 2000
    name = "FULL" if durable else "NORMAL"
    benchmark.extra_info.update(what=f"store, one put, synchronous={name}", each=SINGLE, target_s=target)
    first = iter(range(0, 10**7, SINGLE))
    with open_store(tmp_path / "store.sqlite", durable=durable) as store:
        store.put_many(recordings(10**7, 5))

        def setup() -> tuple[tuple[list[Recording]], dict[str, Any]]:
            return (recordings(next(first), SINGLE),), {}

        benchmark.pedantic(lambda made: [store.put(one) for one in made], setup=setup, rounds=10)


def test_batches(benchmark: Fixture, tmp_path: Path) -> None:
    """Recordings put a thousand at a time."""
    benchmark.extra_info.update(what="store, one recording of a batch", each=BATCH, target_s=1 / 10_000)
    first = iter(range(0, 10**7, BATCH))
    with open_store(tmp_path / "store.sqlite", durable=False) as store:

        def setup() -> tuple[tuple[list[Recording]], dict[str, Any]]:
            return (recordings(next(first), BATCH),), {}

        benchmark.pedantic(store.put_many, setup=setup, rounds=5)


def test_list(benchmark: Fixture, full: Store) -> None:
    """The last 50 of 100,000."""
    benchmark.extra_info.update(what="store, list of 50 of 100,000", target_s=5e-3)
    assert len(benchmark(list_recordings, full).rows) == 50


def test_filter(benchmark: Fixture, full: Store) -> None:
    """50 by gripper and property."""
    benchmark.extra_info.update(what="store, 50 by gripper and property of 100,000", target_s=30e-3)
    wanted = Filter(gripper="gripper3", property="mass")
    assert len(benchmark(list_recordings, full, wanted).rows) == 50


def test_table(benchmark: Fixture, full: Store) -> None:
    """Objects x properties."""
    benchmark.extra_info.update(what="store, objects x properties of 100,000", target_s=250e-3)
    cells = benchmark(objects_by_properties, full)
    assert sum(cell.count for cell in cells) == MANY


def test_curves(benchmark: Fixture, full: Store) -> None:
    """All curves of one gripper: three channels of each series."""
    count = 3 * MANY // 5
    benchmark.extra_info.update(what="store, one curve of a gripper", each=count, target_s=1 / 40_000)

    def run() -> int:
        return sum(len(series.channels) for _, series in curves_of_gripper(full, "gripper2"))

    assert benchmark.pedantic(run, rounds=3) == count
