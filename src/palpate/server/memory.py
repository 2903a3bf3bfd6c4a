"""The memory that answers take at once: samples are read whole, and are there until whoever asked has read them."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import Depends, Request

from palpate.server.problems import problem
from palpate.server.security.askers import Asker, asker_of
from palpate.server.security.rooms import Room
from palpate.server.state import state_of

__all__ = ["Held", "Memory"]

AGAIN_S = 5


class Held:
    """What a request has taken so far, until it is answered to the last byte."""

    def __init__(self, room: Room, asker: Asker) -> None:
        self._room, self._asker = room, asker

    def take(self, size_bytes: int) -> None:
        """Take so many bytes, or end the request with a 503."""
        _check(self._room.enter(self._asker, size_bytes))

    def take_alone(self, size_bytes: int) -> None:
        """Take them even where these are more than there are for anybody, once nobody else has any."""
        _check(self._room.enter(self._asker, size_bytes) or self._room.enter_alone(self._asker, size_bytes))

    def give_back(self) -> None:
        """All of it."""
        self._room.leave(self._asker)


def _check(is_room: bool) -> None:
    if not is_room:
        told = "samples of others are read and sent now, and there is no memory for these; ask again in a moment"
        raise problem(503, told, headers={"Retry-After": str(AGAIN_S)})


async def _held(request: Request) -> AsyncIterator[Held]:
    held = Held(state_of(request).memory, asker_of(request))
    try:
        yield held
    finally:
        # also where whoever asked has gone away in the middle
        held.give_back()


Memory = Annotated[Held, Depends(_held)]
