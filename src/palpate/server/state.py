"""What requests share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from starlette.requests import HTTPConnection

from palpate.server.settings import Settings
from palpate.store.store import Store

__all__ = ["State", "state_of"]


@dataclass(frozen=True)
class State:
    """What requests share: the store, and how the server runs."""

    store: Store
    settings: Settings


def state_of(connection: HTTPConnection) -> State:
    """What requests share."""
    return cast(State, connection.app.state.palpate)
