"""Who asks: how long it has kept the server waiting, with its request or by not reading, and how to end it."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from typing import Any, TypeVar, cast

from starlette.requests import HTTPConnection
from starlette.types import Message, Receive, Scope, Send

from palpate.server.security.addresses import network_of

__all__ = ["ENOUGH_BYTES_PER_S", "Asker", "asker_of", "has_place"]

ENOUGH_BYTES_PER_S = 32 << 10
"""Who sends or takes so many keeps nobody waiting."""
T = TypeVar("T")
PIECE_BYTES = 64 << 10
"""Of an answer, which goes when the one before has nearly gone: a whole one would wait where nobody sees it."""


class Asker:
    """One request, from which and to which everything comes and goes.

    Parameters
    ----------
    end
        Ends the connection, called in any thread; None where the server has not said how.
    """

    def __init__(self, scope: Scope, receive: Receive, send: Send, end: Callable[[], None] | None = None) -> None:
        self.network = network_of(HTTPConnection(scope))
        self._receive, self._send, self._end = receive, send, end
        self._is_heard = self._is_answered = False
        self._owed_s = 0.0
        self._since_s: float | None = None

    @property
    def waited_s(self) -> float:
        """How long it was waited for beyond what its bytes are worth; 0 where it is not waited for now, or for ever."""
        # read once: other threads ask while it changes
        since_s = self._since_s
        return 0.0 if since_s is None or self._end is None else time.monotonic() - since_s

    def end(self) -> None:
        """End the connection, whatever is under way."""
        if self._end is not None:
            self._end()

    async def receive(self) -> Message:
        """Wait for a part of the request, or for the end of the connection."""
        if self._is_heard or self._is_answered:
            return await self._receive()
        message = await self._waiting(self._receive())
        self._moved(message)
        self._is_heard = not message.get("more_body", False)
        return message

    async def send(self, message: Message) -> None:
        """Send a part of the answer, as fast as it is taken."""
        self._is_answered = True
        for piece in _pieces(message):
            await self._waiting(self._send(piece))
            self._moved(piece)

    async def _waiting(self, moving: Awaitable[T]) -> T:
        began_s = self._since_s = time.monotonic() - self._owed_s
        try:
            return await moving
        finally:
            # an answer may begin while more of the request is waited for: then only it counts
            if self._since_s == began_s:
                self._owed_s = time.monotonic() - began_s
                self._since_s = None

    def _moved(self, message: Message) -> None:
        worth_s = len(message.get("body", b"")) / ENOUGH_BYTES_PER_S
        self._owed_s = max(0.0, self._owed_s - worth_s)


def asker_of(connection: HTTPConnection) -> Asker:
    """Whose request it is, which `palpate.server.security.places` has let in."""
    return cast(Asker, connection.state.asker)


def has_place(state: Mapping[str, Any]) -> bool:
    """Whether a request of this state was let in, and is not answered yet."""
    return "asker" in state


def _pieces(message: Message) -> Iterator[Message]:
    body = message.get("body", b"")
    last = max(0, len(body) - 1) // PIECE_BYTES * PIECE_BYTES
    for start in range(0, last, PIECE_BYTES):
        yield {**message, "body": body[start : start + PIECE_BYTES], "more_body": True}
    yield {**message, "body": body[last:]} if last else message
