"""What a request may send, and how long it may take over it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from palpate.server.problems import problem

__all__ = ["BodyLimits"]

GRACE_S = 20.0
"""Before a client counts as slow."""
LEAST_BYTES_PER_S = 8 << 10


class BodyLimits:
    """Refuses bodies that are too large, stated or not, and clients that hold on to a connection by sending slowly.

    Parameters
    ----------
    largest
        Bytes at most, by method and path.
    """

    def __init__(self, app: ASGIApp, *, largest: Callable[[str, str], int], grace_s: float = GRACE_S) -> None:
        self.app = app
        self.largest = largest
        self.grace_s = grace_s

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        body = _Body(receive, self.largest(scope["method"], scope["path"]), _stated_bytes(scope), self.grace_s)
        await self.app(scope, body.receive, send)


class _Body:
    def __init__(self, receive: Receive, largest: int, stated: int, grace_s: float) -> None:
        self._receive = receive
        self._largest = largest
        self._stated = stated
        self._end_s = asyncio.get_running_loop().time() + grace_s
        self._read = 0
        self._whole = False

    async def receive(self) -> Message:
        if self._whole:
            # now only the end of the connection can come, whenever it does
            return await self._receive()
        if self._stated > self._largest:
            raise too_large(self._largest)
        try:
            async with asyncio.timeout_at(self._end_s + self._read / LEAST_BYTES_PER_S):
                message = await self._receive()
        except TimeoutError:
            raise problem(
                408,
                f"{self._read} bytes came, expected {LEAST_BYTES_PER_S} each second",
                headers={"Connection": "close"},
            ) from None
        self._read += len(message.get("body", b""))
        self._whole = not message.get("more_body", False)
        if self._read > self._largest:
            raise too_large(self._largest)
        return message


def too_large(largest: int) -> Exception:
    """The error of a body that is too large."""
    return problem(413, f"the body is too large, expected {largest} bytes at most", headers={"Connection": "close"})


def _stated_bytes(scope: Scope) -> int:
    """How long the body says it is; 0 where it does not say."""
    found = (value for name, value in scope["headers"] if name == b"content-length")
    return next((int(value) for value in found if value.isdigit()), 0)
