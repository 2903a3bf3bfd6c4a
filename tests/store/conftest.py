import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from palpate.store.blobs import FolderBlobs
from palpate.store.bucket import BucketBlobs
from palpate.store.database import connect, migrate
from palpate.store.opening import open_store
from palpate.store.store import Store

POSTGRESQL = os.environ.get("PALPATE_TEST_POSTGRESQL")
"""Address of a PostgreSQL database that the tests may empty."""


def opened(kind: str, folder: Path) -> Store:
    if kind == "postgresql":
        assert POSTGRESQL is not None
        engine = connect(POSTGRESQL)
        migrate(engine, "base")
        engine.dispose()
        return open_store(POSTGRESQL, folder / "blobs")
    store = open_store(folder / "store.sqlite", durable=False)
    # obstore's own store in memory stands for a bucket
    return Store(store.engine, BucketBlobs("memory:///") if kind == "bucket" else FolderBlobs(folder / "blobs"))


@pytest.fixture(params=["sqlite", "bucket", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    """A new store of each kind."""
    if request.param == "postgresql" and POSTGRESQL is None:
        pytest.skip("PALPATE_TEST_POSTGRESQL is not set")
    with opened(request.param, tmp_path) as found:
        yield found


@pytest.fixture
def local(tmp_path: Path) -> Iterator[Store]:
    """A new store in a file."""
    with opened("sqlite", tmp_path) as found:
        yield found
