"""How often one address may ask, and one account by its tokens: a bucket of requests that fills up again."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.problems import Problem, problem_response
from palpate.server.security.addresses import network_of
from palpate.server.security.tokens import PREFIX, digest_of

__all__ = ["Held", "Rate", "RateLimit"]

MOST_ADDRESSES = MOST_TOKENS = 10_000
HELD_S = 60.0
"""After which a token is an address's again for one request: it may have been revoked."""
LONGEST_TOKEN = 100


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
    """Refuses what an address, of IPv6 a network, asks too often; each worker counts for itself.

    Who asks by a token has the rate of its account, which is higher, from the second request on: that a token holds is
    known by an answer to it that an address was let ask. So whoever invents tokens asks no more often, and no token is
    looked up in the database before its request is counted.
    """

    def __init__(self, app: ASGIApp, *, of_address: Rate, of_account: Rate, held: Held | None = None) -> None:
        self.app = app
        self.of_address = of_address
        self.of_account = of_account
        self.held = held or Held()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        secret = _token_in(connection)
        name = None if secret is None else self.held.account_of(secret)
        if name is None:
            wait_s, whose = self.of_address.wait_s(network_of(connection)), "address"
        else:
            wait_s, whose = self.of_account.wait_s(name), "account"
        if wait_s:
            found = Problem(title="Too Many Requests", status=429, detail=f"too many requests from this {whose}")
            # what is asked behind it on this connection need not be answered one by one
            told = {"Retry-After": str(int(wait_s) + 1), "Connection": "close"}
            await problem_response(found, told)(scope, receive, send)
            return
        await self.app(scope, receive, send)
        # where there is one, the token was right: it is looked at before all else that tells who asks
        who = getattr(connection.state, "account", None)
        if secret is not None and name is None and who is not None and who.name is not None:
            self.held.keep(secret, who.name)


class Held:
    """Tokens that were found to hold a moment ago, each by its digest, and whose they are."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._accounts: OrderedDict[bytes, tuple[str, float]] = OrderedDict()

    def account_of(self, secret: str) -> str | None:
        """Whose it is; None where that is not known, or no longer."""
        name, until_s = self._accounts.get(digest_of(secret), (None, 0.0))
        return name if self._clock() < until_s else None

    def keep(self, secret: str, name: str) -> None:
        """It holds now."""
        key = digest_of(secret)
        self._accounts[key] = (name, self._clock() + HELD_S)
        self._accounts.move_to_end(key)
        if len(self._accounts) > MOST_TOKENS:
            self._accounts.popitem(last=False)


def _token_in(connection: HTTPConnection) -> str | None:
    """What may be a token: what is none by its looks costs nothing."""
    scheme, _, secret = connection.headers.get("authorization", "").partition(" ")
    secret = secret.strip()
    is_like_one = scheme.lower() == "bearer" and secret.startswith(PREFIX) and len(secret) <= LONGEST_TOKEN
    return secret if is_like_one else None
