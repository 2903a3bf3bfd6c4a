"""Explorations: lists, and one of them with its steps."""

from __future__ import annotations

from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response

from palpate.server.api import plain
from palpate.server.api.answers import answer, page
from palpate.server.api.models import Episode, EpisodeRow, Page
from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import EpisodeQuery
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store.episodes import StoredEpisode
from palpate.store.keeping_episodes import get_episode
from palpate.store.visible_episodes import episode_is_visible, recordings_of_digests

__all__ = ["SeenEpisode", "router"]

router = APIRouter(prefix="/episodes", tags=["episodes"])


def _episode(store: StoreOf, who: Who, id: UUID) -> StoredEpisode:
    if not episode_is_visible(store, who.viewer, id):
        raise problem(404, f"episode {id}: there is none, or none that you may see")
    return get_episode(store, id)


SeenEpisode = Annotated[StoredEpisode, Depends(_episode)]


@router.get("", response_model=Page[EpisodeRow])
def list_(request: Request, store: StoreOf, who: Who, query: Annotated[EpisodeQuery, Query()]) -> Response:
    """Explorations, the last one first."""
    found = query.found(store, who.viewer)
    return page(request, query, map(plain.episode_row, found.rows), found.cursor)


@router.get("/{id}", response_model=Episode)
def get(store: StoreOf, who: Who, episode: SeenEpisode) -> Response:
    """One exploration: the records of its log, with the recording of each action that may be seen."""
    digests = [step.recording for step in episode.steps if step.recording is not None]
    ids = recordings_of_digests(store, who.viewer, digests)
    steps = [{"record": step.record, "recording": _text(ids.get(step.recording or ""))} for step in episode.steps]
    return answer({**_row(episode), "header": episode.header, "steps": steps})


def _text(id: UUID | None) -> str | None:
    return None if id is None else str(id)


def _row(episode: StoredEpisode) -> dict[str, Any]:
    header = episode.header
    told = {name: str(header.get(name, "")) for name in ("objective", "policy", "robot")}
    return {
        "id": str(episode.id),
        "digest": episode.digest,
        "started_at": plain.moment(episode.started_at),
        "object": plain.thing_name(episode.thing),
        "common_name": episode.thing.common_name,
        "owner": episode.owner,
        "visibility": episode.visibility,
        "embargoed_until": plain.moment(episode.embargoed_until),
        "network": str(header.get("network", {}).get("name", "")),
        **told,
        "actions": episode.actions,
        "stop": episode.stop,
        "url": f"{plain.ROOT}/episodes/{episode.id}",
    }
