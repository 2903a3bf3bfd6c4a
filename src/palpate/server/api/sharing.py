"""Who may see a recording or an exploration: setting it, taking that back, and who did it."""

from __future__ import annotations

from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends
from fastapi.responses import Response

from palpate.server.api import models, plain
from palpate.server.api.answers import answer
from palpate.server.api.parameters import SeenRecording, StoreOf
from palpate.server.api.queries import Moment
from palpate.server.security.accounts import Account, Role
from palpate.server.security.who import needs
from palpate.server.sharing import SharingOf, sharing_of
from palpate.store import schema
from palpate.store.sharing import Sharing

__all__ = ["router"]

router = APIRouter()
recordings = APIRouter(prefix="/recordings/{key}", tags=["recordings"])
episodes = APIRouter(prefix="/episodes/{id}", tags=["episodes"])
Owner = Annotated[Account, Depends(needs(Role.OWNER))]


def _of_recording(store: StoreOf, who: Owner, head: SeenRecording) -> SharingOf:
    return sharing_of(store, who, schema.recordings, head.id)


def _of_episode(store: StoreOf, who: Owner, id: UUID) -> SharingOf:
    return sharing_of(store, who, schema.episodes, id)


OfRecording = Annotated[SharingOf, Depends(_of_recording)]
OfEpisode = Annotated[SharingOf, Depends(_of_episode)]


class Wanted(models.Strict):
    """Who may see it; what is left out stays, and an embargo that is null ends."""

    visibility: models.Visibility = "private"
    embargoed_until: Moment | None = None


@recordings.patch("", response_model=models.Sharing)
def share_recording(sharing: OfRecording, wanted: Wanted) -> Response:
    """Set who may see a recording; nothing of what was measured changes."""
    return _changed(sharing, wanted)


@episodes.patch("", response_model=models.Sharing)
def share_episode(sharing: OfEpisode, wanted: Wanted) -> Response:
    """Set who may see an exploration; its recordings are set by themselves."""
    return _changed(sharing, wanted)


@recordings.post("/undo", response_model=models.Sharing)
def undo_of_recording(sharing: OfRecording) -> Response:
    """Take back the last change of who may see it; again, the one before."""
    return answer(_plain(sharing.undo()))


@episodes.post("/undo", response_model=models.Sharing)
def undo_of_episode(sharing: OfEpisode) -> Response:
    """Take back the last change of who may see it; again, the one before."""
    return answer(_plain(sharing.undo()))


@recordings.get("/history", response_model=models.Page[models.SharingChange])
def history_of_recording(sharing: OfRecording) -> Response:
    """Who changed who may see it, the last first; for those who may change it."""
    return _history(sharing)


@episodes.get("/history", response_model=models.Page[models.SharingChange])
def history_of_episode(sharing: OfEpisode) -> Response:
    """Who changed who may see it, the last first; for those who may change it."""
    return _history(sharing)


def _changed(sharing: SharingOf, wanted: Wanted) -> Response:
    return answer(_plain(sharing.change({name: getattr(wanted, name) for name in wanted.model_fields_set})))


def _plain(sharing: Sharing) -> dict[str, Any]:
    return {"visibility": sharing.visibility, "embargoed_until": plain.moment(sharing.embargoed_until)}


def _history(sharing: SharingOf) -> Response:
    items = [
        {
            "at": plain.moment(one.at),
            "who": one.who,
            "before": _plain(one.before),
            "after": _plain(one.after),
            "undone_at": plain.moment(one.undone_at),
            "undone_by": one.undone_by,
        }
        for one in sharing.history()
    ]
    return answer({"items": items, "next": None})


router.include_router(recordings)
router.include_router(episodes)
