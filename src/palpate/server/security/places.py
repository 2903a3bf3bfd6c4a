"""How many requests are answered at once: of all, and of one address; and those who watch, apart from them."""

from __future__ import annotations

import re
from collections import Counter

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.problems import Problem, problem_response
from palpate.server.security.addresses import network_of

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


class Room:
    """Places for so many, of whom so many may be of one network."""

    def __init__(self, most: int, most_of_a_network: int) -> None:
        self.most, self.most_of_a_network = most, most_of_a_network
        self._taken = Counter[str]()

    def fault(self, network: str) -> Problem | None:
        """Why there is no place for one more of a network; None where there is."""
        if self._taken[network] >= self.most_of_a_network:
            detail = f"{self.most_of_a_network} requests of this address are under way, wait until one is answered"
            return Problem(title="Too Many Requests", status=429, detail=detail)
        if self._taken.total() >= self.most:
            return Problem(
                title="Service Unavailable", status=503, detail="very many ask at once, ask again in a moment"
            )
        return None

    def enter(self, network: str) -> None:
        """Take a place."""
        self._taken[network] += 1

    def leave(self, network: str) -> None:
        """Give it back."""
        self._taken[network] -= 1
        # networks that are gone are forgotten
        self._taken += Counter()


class Places:
    """Refuses what is asked at once beyond what there is room for; each worker has rooms of its own.

    Whether the server is well is answered in any case. Who watches holds a place for long, and takes none of those
    who ask.
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
        network = network_of(HTTPConnection(scope))
        fault = room.fault(network)
        if fault is not None:
            await problem_response(fault, {"Retry-After": str(AGAIN_S)})(scope, receive, send)
            return
        room.enter(network)
        try:
            await self.app(scope, receive, send)
        finally:
            room.leave(network)
