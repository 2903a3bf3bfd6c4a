from collections.abc import Iterator
from pathlib import Path

import pytest

from palpate.store.blobs import FolderBlobs
from palpate.store.opening import open_store
from palpate.store.store import Store
from tests.store.places import KINDS, blobs_of, check_services, emptied


@pytest.fixture(params=KINDS)
def store(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Store]:
    """A new store of each kind: files, a bucket in memory, one of a real service, and PostgreSQL with such a one."""
    kind = request.param
    check_services(kind)
    blobs = blobs_of(kind, tmp_path, monkeypatch)
    place = emptied() if kind == "postgresql" else tmp_path / "store.sqlite"
    opened = open_store(place, tmp_path / "unused", durable=False)
    with Store(opened.engine, blobs) as found:
        yield found


@pytest.fixture
def local(tmp_path: Path) -> Iterator[Store]:
    """A new store in a file, beside that of `store`."""
    opened = open_store(tmp_path / "local.sqlite", durable=False)
    with Store(opened.engine, FolderBlobs(tmp_path / "local.blobs")) as found:
        yield found
