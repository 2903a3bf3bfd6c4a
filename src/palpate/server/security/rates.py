"""How often one address may ask: a bucket of requests that fills up again."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.problems import Problem, problem_response
from palpate.server.security.addresses import network_of

__all__ = ["Rate", "RateLimit"]

MOST_ADDRESSES = 10_000


class Rate:
    """Lets each key do something so often in the long run, and more for a moment.

    Parameters
    ----------
    per_s
        In the long run.
    burst
        At once.

    Examples
    --------
    >>> rate = Rate(per_s=1.0, burst=2, clock=iter([0.0, 0.1, 0.2, 1.3]).__next__)
    >>> [rate.wait_s("someone") for _ in range(4)]
    [0.0, 0.0, 0.8, 0.0]
    """

    def __init__(self, per_s: float, burst: int, clock: Callable[[], float] = time.monotonic) -> None:
        self.per_s = per_s
        self.burst = burst
        self._clock = clock
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def wait_s(self, key: str) -> float:
        """Count one; how long to wait where it is one too many, and then it does not count [s]."""
        now = self._clock()
        wait_s = self._wait_s(key, now)
        if not wait_s:
            self._keep(key, self._now(key, now) - 1, now)
        return wait_s

    def would_wait_s(self, key: str) -> float:
        """As `wait_s`, and nothing is counted: for what several rates count or none [s]."""
        return self._wait_s(key, self._clock())

    def give_back(self, key: str) -> None:
        """Count one less."""
        now = self._clock()
        self._keep(key, min(self.burst, self._now(key, now) + 1), now)

    def _wait_s(self, key: str, now: float) -> float:
        left = self._now(key, now)
        return round((1 - left) / self.per_s, 3) if left < 1 else 0.0

    def _now(self, key: str, now: float) -> float:
        left, at = self._left.get(key, (float(self.burst), now))
        return min(self.burst, left + (now - at) * self.per_s)

    def _keep(self, key: str, left: float, now: float) -> None:
        self._left[key] = (left, now)
        self._left.move_to_end(key)
        if len(self._left) > MOST_ADDRESSES:
            self._left.popitem(last=False)


class RateLimit:
    """Refuses what an address, of IPv6 a network, asks too often; each worker counts for itself."""

    def __init__(self, app: ASGIApp, *, rate: Rate) -> None:
        self.app = app
        self.rate = rate

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        wait_s = self.rate.wait_s(network_of(HTTPConnection(scope))) if scope["type"] == "http" else 0.0
        if wait_s == 0.0:
            await self.app(scope, receive, send)
            return
        found = Problem(title="Too Many Requests", status=429, detail="too many requests from this address")
        await problem_response(found, {"Retry-After": str(int(wait_s) + 1)})(scope, receive, send)
