"""The names under which a server may be asked: a page elsewhere that points its own name here is refused."""

from __future__ import annotations

from collections.abc import Collection

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.problems import Problem, problem_response

__all__ = ["KnownHosts"]


class KnownHosts:
    """Refuses requests by other names than these; any name will do where there are none."""

    def __init__(self, app: ASGIApp, *, hosts: Collection[str]) -> None:
        self.app = app
        self.hosts = frozenset(hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or not self.hosts or _name(HTTPConnection(scope)) in self.hosts:
            await self.app(scope, receive, send)
            return
        found = Problem(title="Misdirected Request", status=421, detail="host: this server is not known by that name")
        await problem_response(found, {})(scope, receive, send)


def _name(connection: HTTPConnection) -> str:
    """The header ``Host`` without the port."""
    host = connection.headers.get("host", "").lower()
    return host[: host.find("]") + 1] if host.startswith("[") else host.partition(":")[0]
