"""Clients that hold on to connections are let go, and others answered meanwhile; and requests that mean two things."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from urllib.request import urlopen

import pytest
import uvicorn

from palpate.server.app import application
from palpate.server.security.connections import MindedConnection
from palpate.server.settings import Settings
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from tests.server.serving import free_port
from tests.store.made_up import squeeze

LARGE = b"\x00" * (24 << 20)


class Hasty(MindedConnection):
    held_s = 0.5


@contextmanager
def connected(port: int) -> Iterator[socket.socket]:
    with socket.create_connection(("127.0.0.1", port), timeout=10) as found:
        yield found


@dataclass
class Served:
    """A server that has little patience, and the address of a large file."""

    server: uvicorn.Server
    port: int
    large: str


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    store = open_store(tmp_path_factory.mktemp("slow") / "store.sqlite", durable=False)
    recording = squeeze(visibility="public", files=(FileItem("large.bin", "application/octet-stream", LARGE),))
    store.put(recording)
    port = free_port()
    app = application(store, Settings(requests_per_s=None))
    server = uvicorn.Server(uvicorn.Config(app, port=port, http=Hasty, log_level="error"))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield Served(server, port, f"/api/v1/recordings/{recording.id}/files/0")
    server.should_exit = True
    thread.join()


def answers(port: int) -> bool:
    with urlopen(f"http://127.0.0.1:{port}/health", timeout=5) as found:
        return bool(found.status == 200)


def ends_within(client: socket.socket, seconds: float, drip: bytes = b"") -> float:
    """Send a byte now and then until the server ends the connection; after how long it did [s]."""
    began = time.monotonic()
    client.settimeout(0.1)
    while time.monotonic() - began < seconds:
        try:
            if drip:
                client.sendall(drip)
            if client.recv(1 << 16) == b"":
                return time.monotonic() - began
        except TimeoutError:
            continue
        except ConnectionError:
            return time.monotonic() - began
    raise AssertionError(f"still open after {seconds} s")


@pytest.mark.parametrize("first", [b"", b"GET /health HTTP/1.1\r\nHost: a\r\n"], ids=["silent", "headers"])
def test_headers_that_do_not_end(served: Served, first: bytes) -> None:
    """However often a letter of them comes; others are answered meanwhile."""
    with connected(served.port) as client:
        client.sendall(first)
        assert answers(served.port)
        ends_within(client, 8, drip=b"X" if first else b"")


def test_a_second_request_that_does_not_end(served: Served) -> None:
    """One that was answered is watched on."""
    with connected(served.port) as client:
        client.sendall(b"GET /health HTTP/1.1\r\nHost: a\r\n\r\n")
        assert client.recv(1 << 16).startswith(b"HTTP/1.1 200")
        client.sendall(b"GET /health HTTP/1.1\r\n")
        ends_within(client, 8, drip=b"X")


def test_a_reader_that_reads_nothing(served: Served) -> None:
    """The answer does not stay in memory for ever; others are answered meanwhile."""
    with connected(served.port) as client:
        client.sendall(f"GET {served.large} HTTP/1.1\r\nHost: a\r\n\r\n".encode())
        assert answers(served.port)
        end_s = time.monotonic() + 10
        while served.server.server_state.connections:
            assert time.monotonic() < end_s
            time.sleep(0.05)
        assert client.recv(1) == b"H"


def test_a_slow_but_honest_reader_gets_all(served: Served) -> None:
    """Who takes some of it between two looks is let read."""
    port, address = served.port, served.large
    with connected(port) as client:
        client.sendall(f"GET {address} HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n".encode())
        found = bytearray()
        while piece := client.recv(1 << 20):
            found += piece
            time.sleep(0.03)
        assert found.endswith(LARGE)


TWO_MEANINGS = {
    "two lengths": b"Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello!",
    "length and chunks": b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"
    b"GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n",
    "unknown encoding": b"Transfer-Encoding: chunked, gzip\r\n\r\n0\r\n\r\n",
    "negative length": b"Content-Length: -1\r\n\r\n",
    "length with a sign": b"Content-Length: +5\r\n\r\nhello",
    "space before colon": b"Content-Length : 5\r\n\r\nhello",
    "folded header": b"X-A: b\r\n Content-Length: 5\r\n\r\nhello",
    "zero in a header": b"X-A: b\0c\r\n\r\n",
    "two hosts": b"Host: b\r\n\r\n",
}


@pytest.mark.parametrize("rest", TWO_MEANINGS.values(), ids=TWO_MEANINGS.keys())
def test_requests_that_mean_two_things(served: Served, rest: bytes) -> None:
    """They are refused or taken as one request: never is what was sent as a body answered as a request."""
    with connected(served.port) as client:
        client.sendall(b"POST /login HTTP/1.1\r\nHost: a\r\n" + rest)
        client.settimeout(3)
        found = b""
        try:
            while piece := client.recv(1 << 16):
                found += piece
        except (TimeoutError, ConnectionError):
            pass
        statuses = [line.split()[1] for line in found.split(b"\r\n") if line.startswith(b"HTTP/1.1 ")]
        assert len(statuses) == 1, found
        assert statuses[0] in (b"400", b"403"), found


def send_without_end(client: socket.socket) -> None:
    for _ in range(200):
        client.sendall(b"GET / HTTP/1.1\r\nX: " + b"a" * (1 << 16))
        time.sleep(0.001)


def test_headers_that_are_too_long(served: Served) -> None:
    """They are refused before they fill the memory."""
    with connected(served.port) as client:
        with pytest.raises(ConnectionError):
            send_without_end(client)
        assert answers(served.port)
