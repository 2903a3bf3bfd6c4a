"""How many requests are answered at once: of all, and of one address; and those who watch, apart from them."""

from __future__ import annotations

import re

from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.problems import Problem, problem_response
from palpate.server.security.askers import Asker
from palpate.server.security.rooms import Room

__all__ = [
    "MOST_REQUESTS",
    "MOST_REQUESTS_OF_A_NETWORK",
    "MOST_WATCHERS",
    "MOST_WATCHERS_OF_A_NETWORK",
    "Places",
    "Room",
]

MOST_REQUESTS, MOST_REQUESTS_OF_A_NETWORK = 250, 100
MOST_WATCHERS, MOST_WATCHERS_OF_A_NETWORK = 100, 40
"""Each of them asks the database twice a second, whose connections requests need too."""
HEALTH = "/health"
EVENTS = re.compile(r"/episodes/[^/]+/events")
AGAIN_S = 2


class Places:
    """Refuses what is asked at once beyond what there is room for; each worker has rooms of its own.

    Whether the server is well is answered in any case. Who watches holds a place for long, and takes none of those
    who ask. Who keeps the server waiting, with what is asked or by not reading, makes place for others that come.
    """

    def __init__(self, app: ASGIApp, *, requests: Room | None = None, watchers: Room | None = None) -> None:
        self.app = app
        self.requests = requests or Room(MOST_REQUESTS, MOST_REQUESTS_OF_A_NETWORK)
        self.watchers = watchers or Room(MOST_WATCHERS, MOST_WATCHERS_OF_A_NETWORK)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or scope["path"] == HEALTH:
            await self.app(scope, receive, send)
            return
        room = self.watchers if EVENTS.fullmatch(scope["path"]) else self.requests
        state = scope.setdefault("state", {})
        asker = Asker(scope, receive, send, state.get("end"))
        if not room.enter(asker):
            fault = _fault(room, asker.network)
            await problem_response(fault, {"Retry-After": str(AGAIN_S)})(scope, receive, send)
            return
        state["asker"] = asker
        try:
            await self.app(scope, asker.receive, asker.send)
        finally:
            room.leave(asker)
            del state["asker"]


def _fault(room: Room, network: str) -> Problem:
    if room.is_full_of(network):
        detail = f"{room.most_of_a_network} requests of this address are under way, wait until one is answered"
        return Problem(title="Too Many Requests", status=429, detail=detail)
    return Problem(title="Service Unavailable", status=503, detail="very many ask at once, ask again in a moment")
