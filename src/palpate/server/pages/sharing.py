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
from palpate.server.pages.templates import page
from palpate.server.security.accounts import Account, Role
from palpate.server.security.sites import form_of
from palpate.server.security.who import needs
from palpate.server.sharing import SharingOf, embargo_end, sharing_of
from palpate.server.uploading.form_words import words_of
from palpate.store import schema
from palpate.store.errors import StoreError
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
    return await _changed(request, await run_in_threadpool(sharing_of, store, who, schema.recordings, id))


@router.post("/episodes/{id}/sharing")
async def of_episode(request: Request, store: StoreOf, who: Owner, id: UUID) -> Response:
    """Set who may see an exploration, or take the last change back."""
    return await _changed(request, await run_in_threadpool(sharing_of, store, who, schema.episodes, id))


def form_values(store: Store, who: Account, table: Any, key: UUID) -> dict[str, Any] | None:
    """What the form of a page shows; None for those who may not change it."""
    sharing = sharing_of(store, who, table, key)
    return _values(sharing) if sharing.may_change else None


def _values(sharing: SharingOf) -> dict[str, Any]:
    now, until = sharing.now.sharing, sharing.now.sharing.embargoed_until
    return {
        "visibility": now.visibility,
        "until": "" if until is None else until.astimezone(UTC).strftime(UNTIL),
        "history": sharing.history()[:10],
        "uploaded_by": sharing.now.uploaded_by,
    }


async def _changed(request: Request, sharing: SharingOf) -> Response:
    fields, address = await form_of(request), request.url.path.removesuffix("/sharing")
    if fields.get("do") == "undo":
        await run_in_threadpool(sharing.undo)
    else:
        try:
            wanted = _fields(fields, sharing)
        except StoreError as error:
            return await run_in_threadpool(_again, request, address, sharing, fields, str(error))
        await run_in_threadpool(sharing.change, wanted)
    return RedirectResponse(address, 303)


def _again(request: Request, address: str, sharing: SharingOf, given: Mapping[str, str], fault: str) -> Response:
    """The form with what was typed, and what is wrong with that."""
    sharing.check()
    typed = {name: given.get(name, "") for name in ("visibility", "until")}
    return page(
        request, "share.html", 422, address=address, sharing={**_values(sharing), **typed}, fault=words_of(fault)
    )


def _fields(given: Mapping[str, str], sharing: SharingOf) -> dict[str, Any]:
    visibility, until = given.get("visibility", ""), given.get("until", "")
    if visibility not in VISIBILITIES:
        raise StoreError(f"visibility: found {visibility[:40]!r}, expected one of {', '.join(VISIBILITIES)}")
    before = sharing.now.sharing.embargoed_until
    if before is not None and until == before.astimezone(UTC).strftime(UNTIL):
        # the field holds whole minutes, and sending it again must not end an embargo earlier
        return {"visibility": visibility}
    return {"visibility": visibility, "embargoed_until": embargo_end(until) if until else None}
