"""The memory that answers take at once: samples are read whole, and whoever reads them slowly holds them for long."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Depends, Request

from palpate.server.problems import problem
from palpate.server.security.addresses import network_of
from palpate.server.security.rooms import Room
from palpate.server.state import state_of

__all__ = ["Held", "Memory"]

AGAIN_S = 5


class Held:
    """What a request has taken so far, until it is answered to the last byte."""

    def __init__(self, room: Room, network: str) -> None:
        self._room, self._network, self._size = room, network, 0

    def take(self, size_bytes: int) -> None:
        """Take so many bytes, or end the request with a 503."""
        self._keep(size_bytes, self._room.enter(self._network, size_bytes))

    def take_alone(self, size_bytes: int) -> None:
        """Take them even where these are more than there are for anybody, once nobody else has any."""
        is_room = self._room.enter(self._network, size_bytes) or self._room.enter_alone(self._network, size_bytes)
        self._keep(size_bytes, is_room)

    def give_back(self) -> None:
        """All of it."""
        self._room.leave(self._network, self._size)
        self._size = 0

    def _keep(self, size_bytes: int, is_room: bool) -> None:
        if not is_room:
            told = "samples of others are read and sent now, and there is no memory for these; ask again in a moment"
            raise problem(503, told, headers={"Retry-After": str(AGAIN_S)})
        self._size += size_bytes


async def _held(request: Request) -> AsyncIterator[Held]:
    held = Held(state_of(request).memory, network_of(request))
    try:
        yield held
    finally:
        # also where whoever asked has gone away in the middle
        held.give_back()


Memory = Annotated[Held, Depends(_held)]
