"""What requests share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from starlette.requests import HTTPConnection

from palpate.server.security.rooms import Room
from palpate.server.security.single_sign_on import Provider
from palpate.server.security.tries import Tries
from palpate.server.settings import Settings
from palpate.store.store import Store

if TYPE_CHECKING:
    from palpate.server.uploading.previews import Previews

__all__ = ["MOST_HELD_BYTES", "MOST_HELD_BYTES_OF_A_NETWORK", "State", "state_of"]

MOST_HELD_BYTES, MOST_HELD_BYTES_OF_A_NETWORK = 768 << 20, 384 << 20


@dataclass(frozen=True)
class State:
    """What requests share.

    Attributes
    ----------
    store, settings
        What is served, and how.
    previews
        Uploads that wait until somebody says that they are to be kept.
    provider
        Who else logs people in; nobody where it is None.
    tries
        How often a log-in is tried.
    memory
        Bytes that samples take while they are read and sent.
    """

    store: Store
    settings: Settings
    previews: Previews
    provider: Provider | None = None
    tries: Tries = field(default_factory=Tries)
    memory: Room = field(default_factory=lambda: Room(MOST_HELD_BYTES, MOST_HELD_BYTES_OF_A_NETWORK))


def state_of(connection: HTTPConnection) -> State:
    """What requests share."""
    return cast(State, connection.app.state.palpate)
