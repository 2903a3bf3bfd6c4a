"""Explorations: lists, one of them with its steps, and those that others send while they run."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Path, Query, Request
from fastapi.responses import Response
from pydantic import AwareDatetime, Field

from palpate.server.api import models, plain
from palpate.server.api.answers import answer, page
from palpate.server.api.models import Episode, EpisodeProgress, EpisodeRow, Page
from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import EpisodeQuery, Text
from palpate.server.explorations import MOST_LINES, add, begin
from palpate.server.memory import Memory
from palpate.server.problems import Problem, problem
from palpate.server.security.accounts import Account, Role
from palpate.server.security.who import Who, needs
from palpate.server.state import state_of
from palpate.store.episodes import StoredEpisode
from palpate.store.keeping_episodes import get_episode
from palpate.store.records import ThingRef
from palpate.store.visible_episodes import episode_is_visible, episode_thing, recordings_of_digests

__all__ = ["SeenEpisode", "router"]

router = APIRouter(prefix="/episodes", tags=["episodes"])
REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": Problem} for status in (400, 401, 403, 404, 409, 413, 422)
}
Owner = Annotated[Account, Depends(needs(Role.OWNER))]


class ThingSent(models.Strict):
    """The object of an exploration."""

    dataset: Text
    id: Text
    common_name: Text | None = None


class EpisodeStart(models.Strict):
    """An exploration that begins: what was explored, and the first line of its log."""

    started_at: AwareDatetime
    thing: ThingSent
    header: dict[str, Any]
    owner: Text | None = None
    visibility: models.Visibility = "private"
    embargoed_until: AwareDatetime | None = None


class LineSent(models.Strict):
    """A line of the log, and the digest of the recording of its action, which was sent before."""

    record: dict[str, Any]
    recording: Annotated[str, Field(pattern="^[0-9a-f]{64}$")] | None = None


def _episode(store: StoreOf, who: Who, id: UUID) -> StoredEpisode:
    if not episode_is_visible(store, who.viewer, id):
        raise problem(404, f"episode {id}: there is none, or none that you may see")
    found = get_episode(store, id)
    return replace(found, thing=episode_thing(store, who.viewer, found.thing))


SeenEpisode = Annotated[StoredEpisode, Depends(_episode)]


@router.get("", response_model=Page[EpisodeRow])
def list_(request: Request, store: StoreOf, who: Who, query: Annotated[EpisodeQuery, Query()]) -> Response:
    """Explorations, the last one first."""
    found = query.found(store, who.viewer)
    return page(request, query, map(plain.episode_row, found.rows), found.cursor)


@router.get("/{id}", response_model=Episode)
def get(store: StoreOf, who: Who, episode: SeenEpisode, memory: Memory) -> Response:
    """One exploration: the records of its log, with the recording of each action that may be seen."""
    digests = [step.recording for step in episode.steps if step.recording is not None]
    ids = recordings_of_digests(store, who.viewer, digests)
    steps = [{"record": step.record, "recording": _text(ids.get(step.recording or ""))} for step in episode.steps]
    found = answer({**_row(episode), "header": episode.header, "steps": steps})
    memory.take(len(found.body))
    return found


@router.put("/{id}", response_model=EpisodeProgress, responses={201: {"model": EpisodeProgress}, **REFUSALS})
def put_episode(request: Request, who: Owner, id: UUID, started: EpisodeStart) -> Response:
    """Begin an exploration under an id of the sender's own: 201 where it is new.

    The same again is 200, and tells how many lines are here: whoever was cut off goes on from there. The header of
    the log is that of `palpate-episode/1`.
    """
    thing = ThingRef(started.thing.dataset, started.thing.id, common_name=started.thing.common_name)
    episode = StoredEpisode(
        started.started_at.astimezone(UTC),
        thing,
        started.header,
        owner=started.owner,
        visibility=started.visibility,
        embargoed_until=started.embargoed_until,
        id=id,
    )
    lines, is_new = begin(state_of(request), who, episode)
    stop = None if is_new else get_episode(state_of(request).store, id).stop
    return _progress(id, lines, stop, is_new)


@router.put(
    "/{id}/lines/{position}", response_model=EpisodeProgress, responses={201: {"model": EpisodeProgress}, **REFUSALS}
)
def put_line(
    request: Request,
    who: Owner,
    episode: SeenEpisode,
    position: Annotated[int, Path(ge=1, le=MOST_LINES)],
    sent: LineSent,
) -> Response:
    """Add a line of the log, the first one at 1: 201 where it is new, 200 where the same is here.

    Another line at a place that is taken, or one that comes before those in front of it, is a 409, and changes nothing.
    The last line has ``stop``, and no other may follow it.
    """
    found, is_new = add(state_of(request), who, episode, position, sent.record, sent.recording)
    return _progress(found.id, len(found.steps), found.stop, is_new)


def _progress(id: UUID, lines: int, stop: str | None, is_new: bool) -> Response:
    found = {"id": str(id), "lines": lines, "stop": stop, "page": f"/episodes/{id}"}
    return answer(found, 201 if is_new else 200, {"Location": f"{plain.ROOT}/episodes/{id}"})


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
