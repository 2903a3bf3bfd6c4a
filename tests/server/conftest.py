from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.server.settings import Settings
from palpate.store.blobs import FolderBlobs
from palpate.store.opening import open_store
from palpate.store.store import Store
from tests.server.browsing import CHROMIUM
from tests.store.places import check_services, emptied

KEY = "the key of whoever started it"
SMALL = Settings(key=KEY, largest_upload_bytes=1 << 20, largest_unpacked_bytes=1 << 20, requests_per_s=None)
Headers = dict[str, str]


@pytest.fixture(params=["sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    """A new store in a file, and one in PostgreSQL."""
    check_services(request.param)
    place = emptied() if request.param == "postgresql" else tmp_path / "store.sqlite"
    opened = open_store(place, tmp_path / "unused", durable=False)
    with Store(opened.engine, FolderBlobs(tmp_path / "blobs")) as found:
        yield found


@pytest.fixture
def client(store: Store) -> Iterator[TestClient]:
    """The application without a network in between; an unforeseen error is an answer as it is for others."""
    with TestClient(application(store, SMALL), raise_server_exceptions=False) as found:
        yield found


@pytest.fixture
def token(store: Store) -> Callable[..., Headers]:
    """Make an account of a role and give the header that its token is sent in."""

    def made(name: str, role: Role = Role.OWNER) -> Headers:
        add_user(store, name, role)
        return {"Authorization": f"Bearer {issue(store, name)}"}

    return made


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium; of one module, as no other event loop may run meanwhile."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as started:
        found = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()
