"""Uploading: a form, what was understood of it, and keeping that."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from types import MappingProxyType
from typing import IO, Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.datastructures import FormData, UploadFile

from palpate.server.api.parameters import StoreOf
from palpate.server.memory import Memory
from palpate.server.pages.allowance import Allowance
from palpate.server.pages.templates import page
from palpate.server.pages.waiting import Owner, Waiting, gone, waiting_preview
from palpate.server.plausible import check_plausible
from palpate.server.problems import problem
from palpate.server.security.accounts import Account
from palpate.server.security.sites import check_same_site, form_of
from palpate.server.state import State, state_of
from palpate.server.uploading.by_hand import recording_by_hand
from palpate.server.uploading.fates import TWICE
from palpate.server.uploading.form_words import words_of
from palpate.server.uploading.keeping import keep
from palpate.server.uploading.preview import Preview, holder_of
from palpate.server.uploading.previews import MOST_OF_ACCOUNT
from palpate.server.uploading.reading import read
from palpate.server.uploading.saving import save
from palpate.server.uploading.showing import shown_episodes, shown_of
from palpate.server.uploading.wishes import Wishes
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.importing.items import Fate
from palpate.store.records import Receipt
from palpate.store.store import Store
from palpate.store.visible_episodes import episode_is_visible, recordings_of_digests

__all__ = ["router"]

router = APIRouter(prefix="/upload")
MOST_FILES = 1_000
NOTHING: Mapping[str, str] = MappingProxyType({})


@router.get("")
def form(request: Request, who: Owner) -> HTMLResponse:
    """The forms: one for files, and one for a measurement that is typed."""
    return _form(request, {}, None)


def _form(request: Request, given: dict[str, str], fault: str | None) -> HTMLResponse:
    largest = state_of(request).settings.largest_upload_bytes
    status = 200 if fault is None else 422
    return page(
        request,
        "upload.html",
        status,
        given=given,
        preset={"recorded_at": f"{datetime.now(UTC):%Y-%m-%dT%H:%M}"},
        fault=None if fault is None else words_of(fault),
        largest=largest,
        most_files=MOST_FILES,
        waiting=MOST_OF_ACCOUNT,
    )


@router.post("")
async def send(request: Request, who: Owner) -> Response:
    """Read what was sent, and lead to what was understood; nothing is kept."""
    state = state_of(request)
    async with request.form(max_files=MOST_FILES, max_fields=10) as sent:
        if not any(isinstance(part, UploadFile) and part.filename for _, part in sent.multi_items()):
            return await run_in_threadpool(_form, request, {}, "No file was chosen.")
        preview = await run_in_threadpool(_read, state, who, holder_of(request, who), sent)
    return RedirectResponse(f"/upload/{preview.id}", 303)


def _read(state: State, who: Account, holder: str, sent: FormData) -> Preview:
    preview = state.previews.new(holder, who.name or "")
    if preview is None:
        raise problem(503, "too many uploads wait to be kept; try again later", headers={"Retry-After": "600"})
    try:
        refused = save(_files(sent), preview.sent, state.settings.largest_unpacked_bytes)
        read(state.store, who, preview, refused)
        state.previews.admit(preview)
    except BaseException:
        state.previews.drop(preview.id)
        raise
    return preview


def _files(sent: FormData) -> Iterator[tuple[str, IO[bytes]]]:
    for _, part in sent.multi_items():
        if isinstance(part, UploadFile) and part.filename:
            yield part.filename, part.file


def _kept_before(request: Request, who: Owner, id: str) -> Preview | None:
    return state_of(request).previews.get_kept(id, holder_of(request, who))


KeptBefore = Annotated[Preview | None, Depends(_kept_before)]


@router.post("/one")
async def by_hand(request: Request, store: StoreOf, who: Owner) -> Response:
    """Keep a measurement that was typed."""
    fields = {name: value.strip() for name, value in (await form_of(request)).items()}
    try:
        receipt = await run_in_threadpool(_keep_typed, store, who, fields)
    except UnavailableError:
        raise
    except StoreError as error:
        return await run_in_threadpool(_form, request, fields, str(error))
    return RedirectResponse(f"/recordings/{receipt.id}", 303)


def _keep_typed(store: Store, who: Account, fields: Mapping[str, str]) -> Receipt:
    recording = recording_by_hand(fields, who)
    for entry in recording.entries:
        check_plausible(store, entry, who.viewer)
    return store.put(recording, uploader=who.name)


@router.get("/{id}")
def preview(request: Request, store: StoreOf, who: Owner, memory: Memory, id: str, kept: KeptBefore) -> Response:
    """What was understood; where it was kept meanwhile, what became of it."""
    if kept is not None:
        return _to_kept(id)
    return _shown(request, store, who, Allowance(memory=memory), waiting_preview(request, who, id))


def _shown(
    request: Request,
    store: Store,
    who: Account,
    left: Allowance,
    waiting: Preview,
    given: Mapping[str, str] = NOTHING,
    fault: str | None = None,
) -> HTMLResponse:
    """What was understood; with what was wanted, and what is wrong with that, where it could not be kept so."""
    items, episodes = shown_of(store, who, waiting, left), shown_episodes(store, who, waiting)
    fates = Counter(item.coming.fate for item in items)
    explored = Counter(one.fate.value for one in episodes)
    return page(
        request,
        "preview.html",
        200 if fault is None else 422,
        preview=waiting,
        waiting=MOST_OF_ACCOUNT,
        given=given,
        fault=fault,
        items=items,
        episodes=episodes,
        new=fates["new"],
        explored=explored["new"],
        known=fates["known"] + explored["known"],
        twice=fates[TWICE],
        refused=fates["refused"] + explored["refused"],
        skipped=fates["skipped"],
    )


@router.post("/{id}/keep")
async def keep_all(request: Request, store: StoreOf, who: Owner, memory: Memory, id: str, kept: KeptBefore) -> Response:
    """Keep what was shown, and lead to what became of it; once, also where the form is sent twice."""
    if kept is None:
        waiting = waiting_preview(request, who, id)
        fields = await form_of(request)
        try:
            wishes = Wishes.of_form(fields)
        except StoreError as error:
            left = Allowance(memory=memory)
            return await run_in_threadpool(_shown, request, store, who, left, waiting, fields, str(error))
        await run_in_threadpool(keep, state_of(request), who, waiting, wishes)
    return _to_kept(id)


def _to_kept(id: str) -> Response:
    return RedirectResponse(f"/upload/{id}/kept", 303)


@router.get("/{id}/kept")
def told(request: Request, store: StoreOf, who: Owner, kept: KeptBefore) -> HTMLResponse:
    """What became of what was kept."""
    if kept is None:
        raise gone()
    outcomes = kept.kept()
    refused = [one for one in outcomes if one["fate"] == Fate.REFUSED.value]
    left = [one for one in outcomes if one["fate"] == Fate.SKIPPED.value]
    held = [one for one in outcomes if "told" in one and one not in refused]
    ids = recordings_of_digests(store, who.viewer, [one["digest"] for one in held if "digest" in one])
    there = [(one, ids[one["digest"]]) for one in held if one.get("digest") in ids]
    explored = [one for one in held if "episode" in one and episode_is_visible(store, who.viewer, UUID(one["episode"]))]
    return page(request, "kept.html", there=there, explored=explored, refused=refused, left=left)


@router.post("/{id}/cancel")
async def cancel(request: Request, who: Owner, waiting: Waiting) -> Response:
    """Forget what was sent."""
    check_same_site(request)
    await run_in_threadpool(state_of(request).previews.drop, waiting.id)
    return RedirectResponse("/upload", 303)
