"""Sending an exploration: its beginning, then a line of its log after the other."""

from __future__ import annotations

import json
from typing import Any
from uuid import UUID

from palpate.client.connection import Connection
from palpate.client.errors import NotThereError, UnreachableError
from palpate.store.content import in_utc
from palpate.store.episodes import StoredEpisode, StoredStep

__all__ = ["begin", "put_line"]

JSON = {"Content-Type": "application/json"}


def begin(connection: Connection, episode: StoredEpisode) -> int:
    """Send the beginning, and return how many lines of it the server has."""
    thing = {"dataset": episode.thing.dataset, "id": episode.thing.id, "common_name": episode.thing.common_name}
    embargo = episode.embargoed_until
    plain = {
        "started_at": in_utc(episode.started_at),
        "thing": thing,
        "header": episode.header,
        "owner": episode.owner,
        "visibility": episode.visibility,
        "embargoed_until": None if embargo is None else in_utc(embargo),
    }
    return _sent(connection, f"/episodes/{episode.id}", episode.id, plain)


def put_line(connection: Connection, id: UUID, position: int, step: StoredStep) -> int:
    """Send a line, the first one at 1, and return how many lines the server has then."""
    plain = {"record": step.record, "recording": step.recording}
    return _sent(connection, f"/episodes/{id}/lines/{position}", id, plain)


def _sent(connection: Connection, path: str, id: UUID, plain: Any) -> int:
    try:
        answer = connection.ask_plain("PUT", path, json.dumps(plain).encode(), JSON)
    except NotThereError as error:
        # the address is wrong, or of a server that takes no explorations yet
        raise UnreachableError(f"{error}; answered 404, expected the address of a service") from None
    found = answer if isinstance(answer, dict) else {}
    if found.get("id") != str(id) or not isinstance(found.get("lines"), int):
        raise connection.strange(f"not about the exploration {id}")
    return int(found["lines"])
