"""Room for so much at once, of which one network may have a part."""

from __future__ import annotations

import threading
from collections import Counter

__all__ = ["Room"]


class Room:
    """Room for so much at once, of which so much may be of one network.

    Examples
    --------
    >>> room = Room(most=3, most_of_a_network=2)
    >>> [room.enter(network) for network in ("here", "here", "here", "there", "elsewhere")]
    [True, True, False, True, False]
    >>> room.leave("here")
    >>> room.enter("elsewhere")
    True
    """

    def __init__(self, most: int, most_of_a_network: int) -> None:
        self.most, self.most_of_a_network = most, most_of_a_network
        self._taken = Counter[str]()
        # threads come at once
        self._lock = threading.Lock()

    def enter(self, network: str, size: int = 1) -> bool:
        """Take so much; whether there was as much for a network."""
        with self._lock:
            is_room = self._taken[network] + size <= self.most_of_a_network and self._taken.total() + size <= self.most
            self._taken[network] += size if is_room else 0
            self._forget()
            return is_room

    def enter_alone(self, network: str, size: int) -> bool:
        """Take however much where nobody has any."""
        with self._lock:
            is_room = not self._taken.total()
            self._taken[network] += size if is_room else 0
            self._forget()
            return is_room

    def leave(self, network: str, size: int = 1) -> None:
        """Give it back."""
        with self._lock:
            self._taken[network] -= size
            self._forget()

    def is_full_of(self, network: str) -> bool:
        """Whether a network has all that it may have."""
        with self._lock:
            return self._taken[network] >= self.most_of_a_network

    def _forget(self) -> None:
        """Networks that have nothing."""
        self._taken = +self._taken
