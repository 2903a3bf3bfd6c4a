"""Parts of addresses as what they stand for; what is not there and what may not be seen look the same."""

from __future__ import annotations

import re
from typing import Annotated
from uuid import UUID

from fastapi import Depends, Path, Request

from palpate.server.names import unescape
from palpate.server.problems import problem
from palpate.server.security.accounts import Account
from palpate.server.security.who import Who
from palpate.server.state import state_of
from palpate.store.parts import Head, head_of
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.visible_things import visible_thing

__all__ = ["Place", "SeenRecording", "SeenThing", "StoreOf", "seen_thing"]

Place = Annotated[int, Path(ge=0, le=1_000_000)]
DIGEST = re.compile("[0-9a-fA-F]{64}")


def _store(request: Request) -> Store:
    return state_of(request).store


StoreOf = Annotated[Store, Depends(_store)]


def _recording(store: StoreOf, who: Who, key: Annotated[str, Path(description="Id or digest.")]) -> Head:
    found = head_of(store, who.viewer, _key(key))
    if found is None:
        raise problem(404, f"recording {key[:80]}: there is none, or none that you may see")
    return found


def _key(text: str) -> UUID | bytes:
    try:
        return bytes.fromhex(text) if DIGEST.fullmatch(text) else UUID(text)
    except ValueError:
        raise problem(404, f"recording {text[:80]}: is no id and no digest") from None


SeenRecording = Annotated[Head, Depends(_recording)]


def _thing(store: StoreOf, who: Who, dataset: str, name: str) -> Thing:
    return seen_thing(store, who, unescape(dataset), unescape(name))


def seen_thing(store: Store, who: Account, dataset: str, name: str) -> Thing:
    """The object of a dataset and a name, or a 404."""
    found = None if "\0" in dataset + name else visible_thing(store, who.viewer, dataset, name)
    if found is None:
        raise problem(404, f"object {dataset}/{name}: there is none, or none that you may see")
    return found


SeenThing = Annotated[Thing, Depends(_thing)]
