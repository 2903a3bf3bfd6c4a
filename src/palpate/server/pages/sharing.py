"""Setting who may see a recording or an exploration, by a form on its page."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.problems import problem
from palpate.server.security.accounts import Account, Role
from palpate.server.security.sites import form_of
from palpate.server.security.who import needs
from palpate.server.sharing import SharingOf, embargo_end, sharing_of
from palpate.store import schema
from palpate.store.records import VISIBILITIES
from palpate.store.store import Store

__all__ = ["UNTIL", "form_values", "router"]

router = APIRouter()
Owner = Annotated[Account, Depends(needs(Role.OWNER))]
UNTIL = "%Y-%m-%dT%H:%M"
"""As a field for a moment of a page holds it."""


@router.post("/recordings/{id}/sharing")
async def of_recording(request: Request, store: StoreOf, who: Owner, id: UUID) -> Response:
    """Set who may see a recording, or take the last change back."""
    sharing = await run_in_threadpool(sharing_of, store, who, schema.recordings, id)
    return await _changed(request, sharing)


@router.post("/episodes/{id}/sharing")
async def of_episode(request: Request, store: StoreOf, who: Owner, id: UUID) -> Response:
    """Set who may see an exploration, or take the last change back."""
    sharing = await run_in_threadpool(sharing_of, store, who, schema.episodes, id)
    return await _changed(request, sharing)


def form_values(store: Store, who: Account, table: Any, key: UUID) -> dict[str, Any] | None:
    """What the form of a page shows; None for those who may not change it."""
    sharing = sharing_of(store, who, table, key)
    if not sharing.may_change:
        return None
    now, until = sharing.now.sharing, sharing.now.sharing.embargoed_until
    return {
        "visibility": now.visibility,
        "until": "" if until is None else until.astimezone(UTC).strftime(UNTIL),
        "history": sharing.history()[:10],
        "uploaded_by": sharing.now.uploaded_by,
    }


async def _changed(request: Request, sharing: SharingOf) -> Response:
    fields = await form_of(request)
    if fields.get("do") == "undo":
        await run_in_threadpool(sharing.undo)
    else:
        await run_in_threadpool(sharing.change, _fields(fields, sharing))
    return RedirectResponse(request.url.path.removesuffix("/sharing"), 303)


def _fields(given: Mapping[str, str], sharing: SharingOf) -> dict[str, Any]:
    visibility, until = given.get("visibility", ""), given.get("until", "")
    if visibility not in VISIBILITIES:
        raise problem(422, f"visibility: found {visibility[:40]!r}, expected one of {', '.join(VISIBILITIES)}")
    before = sharing.now.sharing.embargoed_until
    if before is not None and until == before.astimezone(UTC).strftime(UNTIL):
        # the field holds whole minutes, and sending it again must not end an embargo earlier
        return {"visibility": visibility}
    return {"visibility": visibility, "embargoed_until": embargo_end(until) if until else None}
