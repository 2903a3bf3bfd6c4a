"""Who opens connections and asks nothing, or asks for very much at once, takes nobody else's place."""

import asyncio
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
import uvicorn
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from palpate.server.security.connections import MindedConnection
from palpate.server.security.places import Places
from palpate.server.security.rooms import Room
from tests.server.serving import free_port, served

IDLE = 600
ELSEWHERE = "127.0.0.2"
"""An address of this computer from which no proxy speaks."""


def status(netloc: str, path: str = "/health", source: str = "127.0.0.1") -> int:
    connection = HTTPConnection(netloc, timeout=10, source_address=(source, 0))
    try:
        connection.request("GET", path, headers={"Accept": "text/html", "Host": "127.0.0.1"})
        return connection.getresponse().status
    finally:
        connection.close()


def test_connections_that_ask_nothing_close_no_site(tmp_path: Path) -> None:
    """Neither those that never ask, nor those that have asked once and stay; from any one address."""
    with served(tmp_path / "store.sqlite") as (address, _), ExitStack() as open_:
        place = urlsplit(address)
        for number in range(IDLE):
            source = ("127.0.0.1", ELSEWHERE)[number % 2]
            there = ("127.0.0.1", place.port or 0)
            one = open_.enter_context(socket.create_connection(there, timeout=10, source_address=(source, 0)))
            if number % 3 == 0:
                one.sendall(b"GET /health HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        for source in ("127.0.0.1", ELSEWHERE, "127.0.0.3"):
            assert [status(place.netloc, path, source) for path in ("/health", "/", "/objects")] == [200] * 3


class Few(MindedConnection):
    most_open, most_of_a_network = 6, 3


async def slow(scope: Scope, receive: Receive, send: Send) -> None:
    """An application that answers after a while where it is asked so."""
    if scope["type"] != "http":
        return
    await asyncio.sleep(1.5 if scope["path"] == "/slow" else 0)
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"2")]})
    await send({"type": "http.response.body", "body": b"ok"})


LARGE_BYTES = 8 << 20


async def large(scope: Scope, receive: Receive, send: Send) -> None:
    """An application that answers with more than the system takes, in one part or in two."""
    size = [(b"content-length", str(LARGE_BYTES).encode())]
    await send({"type": "http.response.start", "status": 200, "headers": size})
    body = bytes(LARGE_BYTES)
    if not scope["query_string"]:
        await send({"type": "http.response.body", "body": body[1:], "more_body": True})
        body = body[:1]
    await send({"type": "http.response.body", "body": body})


@contextmanager
def running(app: ASGIApp = slow, **options: Any) -> Iterator[int]:
    port = free_port()
    server = uvicorn.Server(
        uvicorn.Config(Places(app), port=port, http=Few, log_level="error", lifespan="off", **options)
    )
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    try:
        yield port
    finally:
        server.should_exit = True
        thread.join()


def is_open(one: socket.socket) -> bool:
    one.settimeout(0.2)
    try:
        return one.recv(1) != b""
    except TimeoutError:
        return True
    except ConnectionError:
        return False


def opened(stack: ExitStack, port: int, source: str, count: int) -> list[socket.socket]:
    return [
        stack.enter_context(socket.create_connection(("127.0.0.1", port), timeout=10, source_address=(source, 0)))
        for _ in range(count)
    ]


def test_the_longest_idle_connection_makes_room() -> None:
    """Of the same network first, and where there are very many of any; never one whose answer is under way."""
    with running() as port, ExitStack() as stack:
        (asking,) = opened(stack, port, ELSEWHERE, 1)
        asking.sendall(b"GET /slow HTTP/1.1\r\nHost: a\r\n\r\n")
        time.sleep(0.2)
        own = opened(stack, port, ELSEWHERE, 3)
        assert [is_open(one) for one in own] == [False, True, True]
        others = opened(stack, port, "127.0.0.3", 3)
        assert [is_open(one) for one in (*own[1:], *others)] == [True] * 5
        opened(stack, port, "127.0.0.4", 1)
        assert [is_open(one) for one in (*own[1:], *others)] == [False, *[True] * 4]
        asking.settimeout(10)
        assert asking.recv(100).startswith(b"HTTP/1.1 200")


def read_bytes(one: socket.socket) -> int:
    """How much comes until the connection ends."""
    one.settimeout(10)
    found = 0
    try:
        while piece := one.recv(1 << 20):
            found += len(piece)
    except ConnectionError:
        pass
    return found


def test_what_has_no_place_makes_room_though_it_is_under_way() -> None:
    """As the state of the server, which needs none: those who do not read it would have all connections."""
    with running(large) as port, ExitStack() as stack:
        for one in (*opened(stack, port, ELSEWHERE, 3), *opened(stack, port, "127.0.0.3", 3)):
            one.sendall(b"GET /health HTTP/1.1\r\nHost: a\r\n\r\n")
        time.sleep(0.3)
        (other,) = opened(stack, port, "127.0.0.4", 1)
        other.sendall(b"GET / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        assert read_bytes(other) > LARGE_BYTES


def test_a_connection_that_closes_counts_until_it_is_read() -> None:
    """Answers to the last request of a connection are there as long as others, if nobody reads them."""
    with running(large) as port, ExitStack() as stack:
        found = opened(stack, port, ELSEWHERE, 3)
        for one in found:
            one.sendall(b"GET /health?at-once HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
            time.sleep(0.1)
        opened(stack, port, ELSEWHERE, 1)
        assert [read_bytes(one) > LARGE_BYTES for one in found] == [False, True, True]


def test_connections_of_a_proxy_are_those_of_many() -> None:
    """An address that is believed whom it asks for has no limit of its own."""
    with running() as port, ExitStack() as stack:
        assert all(map(is_open, opened(stack, port, "127.0.0.1", 6)))
    with running(forwarded_allow_ips=ELSEWHERE) as port, ExitStack() as stack:
        assert [is_open(one) for one in opened(stack, port, "127.0.0.1", 4)] == [False, True, True, True]


def asked(app: Places, path: str, address: str) -> "asyncio.Task[list[Message]]":
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.request"}

    scope = {"type": "http", "path": path, "method": "GET", "client": (address, 1), "headers": []}

    async def ask() -> list[Message]:
        await app(scope, receive, send)
        return sent

    return asyncio.create_task(ask())


def told(task: "asyncio.Task[list[Message]]") -> tuple[int, bool] | None:
    """The status of an answer and whether it says when to come back; None where it has not come."""
    if not task.done():
        return None
    start = task.result()[0]
    return start["status"], b"retry-after" in dict(start["headers"])


def test_requests_at_once_have_places() -> None:
    """So many of one network and so many of all, and those who watch apart; `/health` needs none."""

    async def ask_all() -> None:
        answering = asyncio.Event()

        async def held(scope: Scope, receive: Receive, send: Send) -> None:
            await answering.wait()
            await send({"type": "http.response.start", "status": 200, "headers": []})

        app = Places(held, requests=Room(3, 2), watchers=Room(2, 1))
        events = "/episodes/0/events"
        asks = [
            ("/", "10.0.0.1", None),
            ("/events", "10.0.0.1", None),
            ("/", "10.0.0.1", (429, True)),
            ("/", "2001:db8::1", None),
            ("/", "2001:db8::2", (503, True)),
            ("/health", "10.0.0.1", None),
            (events, "10.0.0.1", None),
            (events, "10.0.0.1", (429, True)),
            (events, "10.0.0.2", None),
            (events, "10.0.0.3", (503, True)),
        ]
        tasks = [asked(app, path, address) for path, address, _ in asks]
        await asyncio.sleep(0.05)
        assert [told(task) for task in tasks] == [expected for *_, expected in asks]
        answering.set()
        await asyncio.gather(*tasks)
        again = [asked(app, path, "10.0.0.1") for path in ("/", events)]
        await asyncio.gather(*again)
        assert [told(task) for task in again] == [(200, False)] * 2

    asyncio.run(ask_all())


@pytest.mark.parametrize("path", ["/", "/episodes/0/events"])
def test_a_place_is_given_back_where_an_answer_fails(path: str) -> None:
    """Whatever becomes of a request, its place is free again."""

    async def broken(scope: Scope, receive: Receive, send: Send) -> None:
        raise RuntimeError("broken")

    async def ask_all() -> None:
        app = Places(broken, requests=Room(1, 1), watchers=Room(1, 1))
        for _ in range(3):
            with pytest.raises(RuntimeError):
                await asked(app, path, "10.0.0.1")

    asyncio.run(ask_all())


def test_headers_that_are_too_large_are_refused_however_they_come(tmp_path: Path) -> None:
    """Sent at once, in one header or in many or in the address, as in parts; a little less is answered."""
    rest, many = b"Host: 127.0.0.1\r\n", b"".join(b"X-%d: %s\r\n" % (number, b"a" * 90) for number in range(400))
    with served(tmp_path / "store.sqlite") as (address, _):
        for size in (40_000, 70_000):
            one = b"GET /health HTTP/1.1\r\n" + rest + b"X-Long: " + b"a" * size + b"\r\n\r\n"
            assert answered(address, one) == 400
            assert answered(address, one[:9_000], one[9_000:34_000], one[34_000:]) == 400
        assert answered(address, b"GET /health HTTP/1.1\r\n" + rest + many + b"\r\n") == 400
        assert answered(address, b"GET /health?" + b"a" * 40_000 + b" HTTP/1.1\r\n" + rest + b"\r\n") == 400
        assert answered(address, b"GET /health HTTP/1.1\r\n" + rest + b"X-Long: " + b"a" * 32_000 + b"\r\n\r\n") == 200


def answered(address: str, *parts: bytes) -> int:
    """The status of the answer to what is sent part by part."""
    place = urlsplit(address)
    with socket.create_connection(("127.0.0.1", place.port or 0), timeout=10) as one:
        for part in parts:
            one.sendall(part)
            time.sleep(0.2 if len(parts) > 1 else 0)
        return int(one.recv(1000).split()[1])
