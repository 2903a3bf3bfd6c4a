"""HEAD: the headers of GET and no body, for the service, the pages and the files of the site."""

import http.client
from collections.abc import Callable

import pytest
from fastapi.testclient import TestClient

from palpate.server.app import application
from palpate.server.settings import Settings
from palpate.store.records import FileItem
from palpate.store.store import Store
from tests.server.serving import listening
from tests.store.made_up import squeeze

API = "/api/v1/recordings"


@pytest.mark.parametrize("address", ["/", "/objects", API, f"{API}/nothing", "/static/style.css", "/health"])
def test_the_same_headers_without_a_body(client: TestClient, address: str) -> None:
    """Status, type and length are those of GET, also where nothing is there."""
    got, head = client.get(address), client.head(address)
    assert head.status_code == got.status_code
    assert head.content == b""
    for name in ("content-type", "content-length"):
        assert head.headers.get(name) == got.headers.get(name)


def test_a_private_one_is_not_told_of(client: TestClient, store: Store, token: Callable[..., dict[str, str]]) -> None:
    """HEAD tells no more than GET does."""
    recording = squeeze(owner="ann")
    store.put(recording)
    address = f"{API}/{recording.id}"
    assert client.head(address).status_code == 404
    assert client.head(address, headers=token("ann")).status_code == 200


def test_what_only_changes_is_not_asked(client: TestClient) -> None:
    """Where there is no GET there is no HEAD."""
    assert client.head("/logout").status_code == client.get("/logout").status_code == 405


def test_a_connection_goes_on_after_it(store: Store) -> None:
    """On the wire no byte of a body follows: the next answer on the same connection is read right."""
    recording = squeeze(visibility="public", files=(FileItem("a.bin", "application/octet-stream", b"0123456789"),))
    store.put(recording)
    with listening(application(store, Settings(requests_per_s=None))) as url:
        connection = http.client.HTTPConnection(url.removeprefix("http://"), timeout=30)
        for _ in range(2):
            for method, expected in (("HEAD", b""), ("GET", b"0123456789")):
                connection.request(method, f"{API}/{recording.id}/files/0")
                answer = connection.getresponse()
                assert (answer.status, answer.headers["content-length"], answer.read()) == (200, "10", expected)
        connection.close()
