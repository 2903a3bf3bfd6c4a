"""What is asked of a store of 100,000 recordings, on SQLite and PostgreSQL."""

from collections.abc import Iterator
from typing import Any

import pytest

from benchmarks.made_up import fill, new_store
from palpate.store.curves import curves_of_gripper
from palpate.store.filters import Filter
from palpate.store.listing import list_recordings
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties

Fixture = Any  # pytest-benchmark's fixture
MANY = 100_000
TARGETS_S = {"list": 5e-3, "filter": 30e-3, "table": 250e-3, "curve": 1 / 40_000}
"""Of SQLite."""


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def full(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    """A store of 100,000 recordings."""
    with new_store(request.param, tmp_path_factory.mktemp("full")) as store:
        fill(store, MANY)
        with store.engine.execution_options(isolation_level="AUTOCOMMIT").connect() as connection:
            # as PostgreSQL does by itself after a while
            connection.exec_driver_sql("ANALYZE")
        yield store


def tell(benchmark: Fixture, store: Store, kind: str, what: str, **more: int) -> None:
    """Say what is measured; what PostgreSQL takes is reported."""
    if store.engine.dialect.name == "sqlite":
        benchmark.extra_info.update(what=f"store, {what}", target_s=TARGETS_S[kind], **more)
    else:
        benchmark.extra_info.update(what=f"store, {what}, PostgreSQL", **more)


def test_list(benchmark: Fixture, full: Store) -> None:
    """The last 50 of 100,000."""
    tell(benchmark, full, "list", "list of 50 of 100,000")
    assert len(benchmark(list_recordings, full).rows) == 50


def test_filter(benchmark: Fixture, full: Store) -> None:
    """50 by gripper and property."""
    tell(benchmark, full, "filter", "50 by gripper, property")
    wanted = Filter(gripper="gripper3", property="mass")
    assert len(benchmark(list_recordings, full, wanted).rows) == 50


def test_table(benchmark: Fixture, full: Store) -> None:
    """Objects x properties."""
    tell(benchmark, full, "table", "objects x properties")
    cells = benchmark.pedantic(objects_by_properties, (full,), rounds=10)
    assert sum(cell.count for cell in cells) == MANY


def test_curves(benchmark: Fixture, full: Store) -> None:
    """All curves of one gripper: three channels of each series."""
    count = 3 * MANY // 5
    tell(benchmark, full, "curve", "one curve of a gripper", each=count)

    def run() -> int:
        return sum(len(series.channels) for _, series in curves_of_gripper(full, "gripper2"))

    assert benchmark.pedantic(run, rounds=3) == count
