"""Requests by HEAD: what GET would answer, without the body."""

from __future__ import annotations

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["HeadAsGet", "is_head"]

IS_HEAD = "palpate.is_head"


def is_head(connection: HTTPConnection) -> bool:
    """Whether only the headers of the answer are sent, so that a large body need not be read."""
    return IS_HEAD in connection.scope


class HeadAsGet:
    """Answers HEAD as GET, with the headers alone."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self.app(scope, receive, send)
            return

        async def send_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                await send(message)
                # the answer ends here, however long what it is of goes on
                await send({"type": "http.response.body", "body": b"", "more_body": False})

        await self.app({**scope, "method": "GET", IS_HEAD: True}, receive, send_headers)
