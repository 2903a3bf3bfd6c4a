"""What requests share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from starlette.requests import HTTPConnection

from palpate.server.security.tries import Tries
from palpate.server.settings import Settings
from palpate.store.store import Store

if TYPE_CHECKING:
    from palpate.server.uploading.previews import Previews

__all__ = ["State", "state_of"]


@dataclass(frozen=True)
class State:
    """What requests share: the store, how the server runs, uploads that wait, and how often passwords are tried."""

    store: Store
    settings: Settings
    previews: Previews
    tries: Tries = field(default_factory=Tries)


def state_of(connection: HTTPConnection) -> State:
    """What requests share."""
    return cast(State, connection.app.state.palpate)
