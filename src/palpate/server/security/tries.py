"""How often somebody may try to log in."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

from starlette.requests import HTTPConnection

from palpate.server.problems import problem
from palpate.server.security.addresses import network_of
from palpate.server.security.rates import Rate

__all__ = ["Tries"]

LONGEST_NAME = 200
"""Names that are longer, which no account has, are not kept whole."""


@dataclass(frozen=True)
class Tries:
    """Tries to log in, counted for a name from one address, and for an address; each worker counts for itself.

    So nobody locks out others by trying their names, and nobody tries one password for many names.
    """

    of_name_here: Rate = field(default_factory=lambda: Rate(per_s=1 / 30, burst=10))
    of_address: Rate = field(default_factory=lambda: Rate(per_s=1 / 10, burst=30))
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def count(self, connection: HTTPConnection, name: str) -> None:
        """Count one, before it is known whether it is the right one, as others may be under way.

        It is refused with a 429, and not counted, where there were too many.
        """
        counted = self._counted(connection, name)
        # threads may try at once
        with self._lock:
            wait_s = max(rate.would_wait_s(key) for rate, key in counted)
            if not wait_s:
                for rate, key in counted:
                    rate.wait_s(key)
        if wait_s:
            headers = {"Retry-After": str(int(wait_s) + 1)}
            raise problem(429, "too many tries to log in; wait a little", headers=headers)

    def give_back(self, connection: HTTPConnection, name: str) -> None:
        """Count one less, as it was the right one and no guess."""
        with self._lock:
            for rate, key in self._counted(connection, name):
                rate.give_back(key)

    def _counted(self, connection: HTTPConnection, name: str) -> tuple[tuple[Rate, str], ...]:
        network = network_of(connection)
        return ((self.of_name_here, f"{network} {name[:LONGEST_NAME]}"), (self.of_address, network))
