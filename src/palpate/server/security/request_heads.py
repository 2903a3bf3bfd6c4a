"""How much may stand in front of the body of a request."""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.problems import Problem, problem_response

__all__ = ["LARGEST_HEADERS_BYTES", "HeadLimit"]

LARGEST_HEADERS_BYTES = 32 << 10
BETWEEN_BYTES = len(b": \r\n")


class HeadLimit:
    """Refuses a request whose address and headers are larger than that.

    The server's own limit is for what has not come to its end yet: what comes at once passes it.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or _size_bytes(scope) <= LARGEST_HEADERS_BYTES:
            await self.app(scope, receive, send)
            return
        told = (
            f"headers: the address and they have {_size_bytes(scope)} bytes, expected {LARGEST_HEADERS_BYTES} at most"
        )
        found = Problem(title="Bad Request", status=400, detail=told)
        await problem_response(found, {"Connection": "close"})(scope, receive, send)


def _size_bytes(scope: Scope) -> int:
    headers = sum(len(name) + len(value) + BETWEEN_BYTES for name, value in scope["headers"])
    return len(scope.get("raw_path") or scope["path"]) + len(scope["query_string"]) + headers
