"""How often somebody may try to log in."""

from __future__ import annotations

from dataclasses import dataclass, field

from starlette.requests import HTTPConnection

from palpate.server.problems import problem
from palpate.server.security.addresses import network_of
from palpate.server.security.rates import Rate

__all__ = ["Tries"]


@dataclass(frozen=True)
class Tries:
    """Tries to log in, counted for a name from one address, and for an address; each worker counts for itself.

    So nobody locks out others by trying their names, and nobody tries one password for many names.
    """

    of_name_here: Rate = field(default_factory=lambda: Rate(per_s=1 / 30, burst=10))
    of_address: Rate = field(default_factory=lambda: Rate(per_s=1 / 10, burst=30))

    def check(self, connection: HTTPConnection, name: str) -> None:
        """Refuse one more with a 429 where there were too many; it is not counted."""
        wait_s = max(rate.would_wait_s(key) for rate, key in self._counted(connection, name))
        if wait_s:
            headers = {"Retry-After": str(int(wait_s) + 1)}
            raise problem(429, "too many tries to log in; wait a little", headers=headers)

    def count(self, connection: HTTPConnection, name: str) -> None:
        """Count one."""
        for rate, key in self._counted(connection, name):
            rate.wait_s(key)

    def _counted(self, connection: HTTPConnection, name: str) -> tuple[tuple[Rate, str], ...]:
        network = network_of(connection)
        return ((self.of_name_here, f"{network} {name}"), (self.of_address, network))
