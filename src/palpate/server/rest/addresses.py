"""``/rest/``: what scripts of the old program send, kept by the same rules as all else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any
from uuid import NAMESPACE_URL, UUID, uuid5

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse, Response

from palpate.errors import PalpateError
from palpate.server.problems import problem
from palpate.server.receiving import check_owner
from palpate.server.rest.additions import addition_of_form
from palpate.server.rest.forms import Form, form_in
from palpate.server.rest.measurements import recording_of_form
from palpate.server.rest.proposals import proposal_of_form
from palpate.server.security.accounts import Account
from palpate.server.security.basic import BasicOwner
from palpate.server.state import State, state_of
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.parts import head_of
from palpate.store.records import Recording

__all__ = ["router"]

router = APIRouter(prefix="/rest")
SAME_TIME = datetime(2000, 1, 1, tzinfo=UTC)
PRIVATE = "the form does not say who may see it: it is private"


@router.post("/measurements/")
async def post_measurement(request: Request, who: BasicOwner) -> Response:
    """Keep a measurement, and tell what was odd: 201 where it is new, 200 where the account has sent it before."""
    async with form_in(request, "measurement") as form:
        return await run_in_threadpool(_kept, request, who, form, recording_of_form)


@router.post("/entries/")
async def post_entry(request: Request, who: BasicOwner) -> Response:
    """Keep a result of a measurement that is here."""
    store = state_of(request).store
    async with form_in(request, "entry") as form:
        return await run_in_threadpool(
            _kept, request, who, form, lambda form: addition_of_form(store, who.viewer, form)
        )


@router.post("/grasp_proposals/")
async def post_proposal(request: Request, who: BasicOwner) -> Response:
    """Keep a grasp that is proposed for an object."""
    async with form_in(request, "grasp_proposal") as form:
        return await run_in_threadpool(_kept, request, who, form, proposal_of_form)


def _kept(request: Request, who: Account, form: Form, read: Callable[[Form], Recording]) -> Response:
    state = state_of(request)
    try:
        recording, new = _keep(state, who, form, read)
    except UnavailableError:
        raise
    except (PalpateError, MemoryError, RecursionError, OverflowError) as error:
        told = str(error) if isinstance(error, PalpateError) else "holds numbers that are too large, or is too deep"
        raise problem(400, " ".join(told.replace(f"{form.folder}/", "").split())) from None
    return JSONResponse(_plain(request, recording, new), 201 if new else 200)


def _keep(state: State, who: Account, form: Form, read: Callable[[Form], Recording]) -> tuple[Recording, bool]:
    """Put a recording under an id of what is in it, as the form has no time by which it is known again."""
    recording = replace(read(form), owner=who.name)
    if recording.visibility == "private":
        form.notices.append(PRIVATE)
    recording = replace(recording, notices=tuple(form.notices))
    check_owner(recording, who)
    same = replace(recording, recorded_at=SAME_TIME).digest
    recording = replace(recording, id=uuid5(NAMESPACE_URL, f"palpate:rest:{same}"))
    if _is_there(state, who, recording.id):
        return recording, False
    try:
        return recording, state.store.put(recording, uploader=who.name).new
    except UnavailableError:
        raise
    except StoreError:
        # the same was sent by two requests at once
        if _is_there(state, who, recording.id):
            return recording, False
        raise


def _is_there(state: State, who: Account, id: UUID) -> bool:
    return head_of(state.store, who.viewer, id) is not None


def _plain(request: Request, recording: Recording, new: bool) -> dict[str, Any]:
    root = str(request.base_url).rstrip("/")
    return {
        "id": str(recording.id),
        "url": f"{root}/api/v1/recordings/{recording.id}",
        "page": f"{root}/recordings/{recording.id}",
        "owner": recording.owner,
        "visibility": recording.visibility,
        "new": new,
        "odd": list(recording.notices),
    }
