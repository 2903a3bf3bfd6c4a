"""Explorations: a list, and stepping through one of them."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse
from pydantic import BaseModel, ConfigDict, Field

from palpate.episode.format import Episode, LoggedStep
from palpate.errors import LogError
from palpate.robots.simulated_truth import LOOKS_LIKE
from palpate.server.api.downloads import SHOWN
from palpate.server.api.episodes import SeenEpisode
from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import EpisodeQuery
from palpate.server.explorations import last_at, read_episode
from palpate.server.pages.sharing import form_values
from palpate.server.pages.templates import page
from palpate.server.plots.beliefs import belief_rows
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.server.verdicts import verdicts
from palpate.store import schema
from palpate.store.episodes import StoredEpisode
from palpate.store.parts import Head, head_of
from palpate.store.visible_things import visible_thing
from palpate.wording import outcome_words

__all__ = ["router"]

router = APIRouter(prefix="/episodes")
UNLIKELY = 0.05
"""An outcome whose surprise number is less is pointed out."""
QUIET, GONE = timedelta(minutes=5), timedelta(hours=2)
"""After them an exploration that says nothing is said to be quiet, and to be interrupted."""


@router.get("")
def rows(request: Request, store: StoreOf, who: Who, query: Annotated[EpisodeQuery, Query()]) -> HTMLResponse:
    """A list of explorations."""
    found = query.found(store, who.viewer)
    return page(request, "episodes.html", rows=found.rows, cursor=found.cursor, asked=query)


class Asked(BaseModel):
    """Which step; the last one unless told."""

    model_config = ConfigDict(extra="forbid")

    step: int | None = Field(None, ge=1, le=100_000)


@router.get("/{id}")
def one(
    request: Request, store: StoreOf, who: Who, stored: SeenEpisode, asked: Annotated[Asked, Query()]
) -> HTMLResponse:
    """One exploration at one of its steps."""
    episode = _read(stored)
    if asked.step is not None and asked.step > len(episode.steps):
        raise problem(404, f"step: found {asked.step}, expected one of the {len(episode.steps)} steps")
    place = asked.step or len(episode.steps)
    step = episode.steps[place - 1] if episode.steps else None
    recording = _recording(store, who, stored, place)
    thing = visible_thing(store, who.viewer, stored.thing.dataset, stored.thing.id)
    return page(
        request,
        "episode.html",
        stored=stored,
        sharing=form_values(store, who, schema.episodes, stored.id),
        episode=episode,
        place=place,
        step=step,
        gains=_gains(step),
        outcome=None if step is None else outcome_words(step.admitted),
        rows=[] if step is None else belief_rows(step.before, step.after),
        truths={} if step is None or thing is None else verdicts(thing.known, step.after),
        looks_like=None if thing is None else thing.ref.attributes.get(LOOKS_LIKE),
        oddest=_oddest(episode),
        recording=None if recording is None else str(recording.id),
        pictures=[] if recording is None else _pictures(recording),
        lines=[(one.index, one.action, outcome_words(one.admitted), one) for one in episode.steps],
        last=last_at(stored),
        state=_state(stored),
        newest=asked.step is None,
    )


def _oddest(episode: Episode) -> LoggedStep | None:
    """The step whose outcome was expected least; None where none was unlikely."""
    rated = [(step.surprise, step.index, step) for step in episode.steps if step.surprise is not None]
    surprise, _, step = min(rated, default=(1.0, 0, None), key=lambda one: one[:2])
    return step if surprise < UNLIKELY else None


def _state(stored: StoredEpisode) -> str:
    """Whether it is over, goes on, has been quiet for long, or was interrupted as far as anybody can tell."""
    if stored.stop is not None:
        return "over"
    quiet = datetime.now(UTC) - last_at(stored)
    return "running" if quiet < QUIET else "quiet" if quiet < GONE else "interrupted"


def _read(stored: StoredEpisode) -> Episode:
    try:
        return read_episode(stored)
    except LogError as error:
        raise problem(422, str(error)) from None


def _gains(step: LoggedStep | None) -> list[tuple[str, float, float]]:
    """Each action with its expected gain [bits] and its share of the greatest one, the greatest first."""
    if step is None:
        return []
    most = max(step.gains_bits.values(), default=0.0) or 1.0
    ranked = sorted(step.gains_bits.items(), key=lambda item: -item[1])
    return [(action, gain, gain / most) for action, gain in ranked]


def _recording(store: StoreOf, who: Who, stored: StoredEpisode, place: int) -> Head | None:
    """The recording of a step's action, where there is one to see."""
    for line in stored.steps:
        if line.record.get("step") == place and line.recording is not None:
            return head_of(store, who.viewer, bytes.fromhex(line.recording))
    return None


def _pictures(head: Head) -> list[dict[str, str]]:
    """Files of a recording that a browser shows as pictures."""
    return [
        {"name": item.name, "url": f"/api/v1/recordings/{head.id}/files/{place}"}
        for place, item in enumerate(head.files)
        if item.media_type in SHOWN and item.media_type.startswith("image/")
    ]
