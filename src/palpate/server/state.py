"""What requests share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from starlette.requests import HTTPConnection

from palpate.server.security.single_sign_on import Provider
from palpate.server.security.tries import Tries
from palpate.server.settings import Settings
from palpate.store.store import Store

if TYPE_CHECKING:
    from palpate.server.uploading.previews import Previews

__all__ = ["State", "state_of"]


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
    """

    store: Store
    settings: Settings
    previews: Previews
    provider: Provider | None = None
    tries: Tries = field(default_factory=Tries)


def state_of(connection: HTTPConnection) -> State:
    """What requests share."""
    return cast(State, connection.app.state.palpate)
