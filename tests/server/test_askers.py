"""How long somebody who asks has kept the server waiting, and who of them makes place."""

import asyncio
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Any

import pytest
import uvicorn
from hypothesis import given
from hypothesis import strategies as st
from starlette.types import Message, Receive, Scope, Send

from palpate.server.security import askers, rooms
from palpate.server.security.askers import Asker
from palpate.server.security.connections import MindedConnection
from palpate.server.security.places import Places
from palpate.server.security.rooms import Room
from tests.server.serving import free_port

SCOPE: Scope = {"type": "http", "client": ("192.0.2.1", 1), "headers": []}
LARGE = b"\x00" * (32 << 20)


class Line:
    """What comes and goes, and how long each of it takes on a clock that is set by hand."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *parts: tuple[float, bytes, bool]) -> None:
        self.now_s, self.waited_s, self.sent = 0.0, list[float](), list[Message]()
        self._parts = iter(parts)
        monkeypatch.setattr(time, "monotonic", lambda: self.now_s)
        self.asker = Asker(SCOPE, self._receive, self._send, lambda: None)

    def _pass(self, seconds: float) -> None:
        self.now_s += seconds
        self.waited_s.append(self.asker.waited_s)

    async def _receive(self) -> Message:
        seconds, body, more = next(self._parts)
        self._pass(seconds)
        return {"type": "http.request", "body": body, "more_body": more}

    async def _send(self, message: Message) -> None:
        seconds, _, _ = next(self._parts)
        self._pass(seconds)
        self.sent.append(message)


def test_bytes_are_worth_some_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is waited for is added up, less a second for 32 KiB; nothing is owed while nobody is waited for."""
    line = Line(monkeypatch, (3.0, b"x" * (64 << 10), True), (4.0, b"", False), (9.0, b"", False), (1.0, b"", True))

    async def converse() -> None:
        for _ in range(3):
            await line.asker.receive()
            assert line.asker.waited_s == 0.0
        await line.asker.send({"type": "http.response.body", "body": b""})

    asyncio.run(converse())
    # 3 s, less 2 s; the end of the connection may come whenever it does; what was owed stays
    assert line.waited_s == [3.0, 5.0, 0.0, 6.0]


@given(st.integers(0, 5 * askers.PIECE_BYTES), st.booleans())
def test_an_answer_goes_piece_by_piece(size: int, more: bool) -> None:
    """None is longer than a piece, nothing is lost, and only the last one may be the end."""
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    body = bytes(range(256)) * (size // 256) + bytes(size % 256)
    message = {"type": "http.response.body", "body": body, "more_body": more}
    asyncio.run(Asker(SCOPE, lambda: None, send).send(message))  # type: ignore[arg-type, return-value]
    assert b"".join(piece["body"] for piece in sent) == body
    assert [piece["more_body"] for piece in sent] == [*[True] * (len(sent) - 1), more]
    assert max(len(piece["body"]) for piece in sent) <= askers.PIECE_BYTES
    assert len(sent) == max(1, -(-size // askers.PIECE_BYTES))


def test_who_cannot_be_ended_is_not_slow() -> None:
    """Where the server has not said how, room is made by nobody."""

    async def converse() -> float:
        never = asyncio.Event()
        asker = Asker(SCOPE, never.wait, never.wait)  # type: ignore[arg-type]
        task = asyncio.create_task(asker.receive())
        await asyncio.sleep(0.02)
        task.cancel()
        return asker.waited_s

    assert asyncio.run(converse()) == 0.0


def test_what_is_waited_for_once_an_answer_begins() -> None:
    """Whether it is read: the end of a request that nobody needs may come whenever it does."""

    async def converse() -> list[float]:
        comes, goes = asyncio.Event(), asyncio.Event()

        async def receive() -> Message:
            await comes.wait()
            return {"type": "http.request", "body": b"", "more_body": False}

        async def send(_: Message) -> None:
            await goes.wait()

        found = list[float]()
        asker = Asker(SCOPE, receive, send, lambda: None)
        hearing = asyncio.create_task(asker.receive())
        await asyncio.sleep(0.3)
        found.append(asker.waited_s)
        sending = asyncio.create_task(asker.send({"type": "http.response.body", "body": b""}))
        await asyncio.sleep(0.1)
        comes.set()
        await hearing
        found.append(asker.waited_s)
        goes.set()
        await sending
        found.append(asker.waited_s)
        return found

    request_s, answer_s, after_s = asyncio.run(converse())
    assert request_s >= 0.3
    assert 0.1 <= answer_s < 0.3
    assert after_s == 0.0


async def answer(scope: Scope, receive: Receive, send: Send) -> None:
    """Read all that is sent, and answer with little or much."""
    more = True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            return
        more = message["more_body"]
    body = LARGE if scope["path"] == "/large" else b"there"
    size = [(b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 200, "headers": size})
    await send({"type": "http.response.body", "body": body})


@contextmanager
def running(monkeypatch: pytest.MonkeyPatch, places: partial[Places]) -> Iterator[int]:
    monkeypatch.setattr(rooms, "LONGEST_WAIT_S", 0.5)
    monkeypatch.setattr(rooms, "SHORTEST_WAIT_S", 0.1)
    port = free_port()
    options: dict[str, Any] = {"http": MindedConnection, "log_level": "error", "lifespan": "off"}
    server = uvicorn.Server(uvicorn.Config(places(answer), port=port, **options))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield port
    server.should_exit = True
    thread.join()


def asked(stack: ExitStack, port: int, request: bytes, source: str) -> socket.socket:
    there = ("127.0.0.1", port)
    found = stack.enter_context(socket.create_connection(there, timeout=10, source_address=(source, 0)))
    found.sendall(request)
    return found


QUICK = b"GET /quick HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"
SLOW = {
    "reading": b"GET /large HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n",
    "sending": b"POST /quick HTTP/1.1\r\nHost: a\r\nContent-Length: 100\r\n\r\n",
}


def read_all(one: socket.socket) -> bytes:
    found = bytearray()
    while piece := one.recv(1 << 20):
        found += piece
    return bytes(found)


@pytest.mark.parametrize("slow", SLOW.values(), ids=SLOW.keys())
def test_who_is_slow_makes_place(monkeypatch: pytest.MonkeyPatch, slow: bytes) -> None:
    """Addresses that fill all places by reading or sending next to nothing lose them as soon as others come."""
    with running(monkeypatch, partial(Places, requests=Room(4, 2))) as port, ExitStack() as stack:
        holding = [asked(stack, port, slow, f"127.0.0.{2 + number // 2}") for number in range(4)]
        time.sleep(0.8)
        for source in ("127.0.0.2", "127.0.0.9", "127.0.0.10"):
            assert read_all(asked(stack, port, QUICK, source)).startswith(b"HTTP/1.1 200")
        ended = 0
        for one in holding:
            one.settimeout(0.2)
            try:
                read = read_all(one)
            except TimeoutError:
                continue
            except ConnectionError:
                read = b""
            ended += len(read) < len(LARGE)
        assert 1 <= ended <= 3


def test_who_reads_gets_all_while_others_come(monkeypatch: pytest.MonkeyPatch) -> None:
    """A place is not taken from one who takes enough, however long that lasts."""
    with running(monkeypatch, partial(Places, requests=Room(1, 1))) as port, ExitStack() as stack:
        reading = asked(stack, port, SLOW["reading"], "127.0.0.2")
        found, began = bytearray(), time.monotonic()
        while piece := reading.recv(1 << 20):
            found += piece
            time.sleep(0.02)
            if len(found) < len(LARGE) // 2:
                assert read_all(asked(stack, port, QUICK, "127.0.0.3")).startswith(b"HTTP/1.1 503")
        is_whole = found.endswith(LARGE)
        assert is_whole
        assert time.monotonic() - began > 0.5


def test_who_reads_steadily_keeps_nobody_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor while the system has megabytes of the answer, which it would take at once and then none for seconds."""
    with running(monkeypatch, partial(Places, requests=Room(1, 1))) as port, ExitStack() as stack:
        monkeypatch.setattr(rooms, "LONGEST_WAIT_S", 1.0)
        monkeypatch.setattr(rooms, "SHORTEST_WAIT_S", 1.0)
        reading = asked(stack, port, SLOW["reading"], "127.0.0.2")
        for _ in range(10):
            for _ in range(10):
                assert reading.recv(12 << 10)
                time.sleep(0.025)
            assert read_all(asked(stack, port, QUICK, "127.0.0.3")).startswith(b"HTTP/1.1 503")
