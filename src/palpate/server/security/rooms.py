"""Room for so much at once, of which one network may have a part, and who is slow makes room for others."""

from __future__ import annotations

import threading
from collections import Counter
from typing import Protocol

__all__ = ["LONGEST_WAIT_S", "SHORTEST_WAIT_S", "Holder", "Room"]

LONGEST_WAIT_S, SHORTEST_WAIT_S = 5.0, 1.0
"""For which others wait at most, where a network has little of the room, and where it has all that it may."""
CROWD, CROWDED_WAIT_S = 10, 0.1
"""So much shorter where one network is there so many times as often as the one that comes."""


class Holder(Protocol):
    """Who has a part of a room."""

    @property
    def network(self) -> str:
        """Where it comes from."""

    @property
    def waited_s(self) -> float:
        """For how long it has kept the server waiting."""

    def end(self) -> None:
        """Make it give back what it has, soon."""


class Room:
    """Room for so much at once, of which so much may be of one network.

    Where there is none left, those are ended that have kept the server waiting for longest. The more its network has,
    the shorter a holder may: else a few could fill the room again and again in less time than any of them is ended.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Asker:
    ...     network: str
    ...     waited_s: float = 0.0
    ...     def end(self):
    ...         print("ended", self.network)
    >>> room = Room(most=3, most_of_a_network=2)
    >>> [room.enter(Asker(network, number / 10)) for number, network in enumerate(["here", "here", "here", "there"])]
    [True, True, False, True]
    >>> room.enter(Asker("elsewhere"))
    False
    >>> room.leave(Asker("there", 0.3))
    >>> room.enter(Asker("elsewhere", 9.0)), room.enter(Asker("next"))
    ended elsewhere
    (True, True)
    """

    def __init__(self, most: int, most_of_a_network: int) -> None:
        self.most, self.most_of_a_network = most, most_of_a_network
        self._sizes: dict[Holder, int] = {}
        self._taken = Counter[str]()
        # threads come at once
        self._lock = threading.Lock()

    def enter(self, holder: Holder, size: int = 1) -> bool:
        """Take so much, or so much more; whether there was as much, or those who are slow made room for it."""
        with self._lock:
            own, all_ = (taken + size for taken in (self._taken[holder.network], self._taken.total()))
            return self._take(holder, size, own - self.most_of_a_network, all_ - self.most)

    def enter_alone(self, holder: Holder, size: int) -> bool:
        """Take however much where nobody has any, but those who are slow."""
        with self._lock:
            return self._take(holder, size, 0, self._taken.total())

    def leave(self, holder: Holder) -> None:
        """Give all of it back; nothing happens where it has none."""
        with self._lock:
            self._drop(holder)

    def is_full_of(self, network: str) -> bool:
        """Whether a network has all that it may have."""
        with self._lock:
            return self._taken[network] >= self.most_of_a_network

    def _take(self, holder: Holder, size: int, own_missing: int, missing: int) -> bool:
        """Take it where those who are slow have what is missing: of what its network may have, and of all."""
        gone: list[Holder] = []
        for one in self._slow(holder, own_first=own_missing > 0) if own_missing > 0 or missing > 0 else ():
            is_own = one.network == holder.network
            if max(own_missing, missing) <= 0 or (own_missing > 0 and not is_own):
                break
            gone.append(one)
            missing -= self._sizes[one]
            own_missing -= self._sizes[one] if is_own else 0
        if max(own_missing, missing) > 0:
            return False
        for one in gone:
            self._drop(one)
            one.end()
        self._sizes[holder] = self._sizes.get(holder, 0) + size
        self._taken[holder.network] += size
        return True

    def _slow(self, holder: Holder, *, own_first: bool) -> list[Holder]:
        """Others that are slow, the slowest first."""
        waited_s = {one: one.waited_s for one in self._sizes if one is not holder}
        count = Counter(one.network for one in waited_s)
        few = CROWD * (count[holder.network] + 1)
        slow = [one for one, s in waited_s.items() if s > self._may_wait_s(one.network, count[one.network] >= few)]
        return sorted(slow, key=lambda one: (own_first and one.network != holder.network, -waited_s[one]))

    def _may_wait_s(self, network: str, is_crowd: bool) -> float:
        free = 1.0 - self._taken[network] / self.most_of_a_network
        return CROWDED_WAIT_S if is_crowd else max(SHORTEST_WAIT_S, LONGEST_WAIT_S * free)

    def _drop(self, holder: Holder) -> None:
        self._taken[holder.network] -= self._sizes.pop(holder, 0)
        # networks that have nothing
        self._taken = +self._taken
