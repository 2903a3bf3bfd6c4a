"""Uploading: a form, what was understood of it, and keeping that."""

from __future__ import annotations

import logging
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
from palpate.server.pages.saved import saved
from palpate.server.pages.templates import page, search
from palpate.server.pages.waiting import Owner, Waiting, gone, waiting_preview
from palpate.server.plausible import check_plausible
from palpate.server.problems import ProblemError, problem
from palpate.server.security.accounts import Account
from palpate.server.security.sites import check_same_site, form_of
from palpate.server.state import State, state_of
from palpate.server.uploading.by_hand import recording_by_hand
from palpate.server.uploading.fates import TWICE
from palpate.server.uploading.form_words import words_of
from palpate.server.uploading.keeping import keep
from palpate.server.uploading.mine import mine_of
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

_log = logging.getLogger("palpate.server")
router = APIRouter(prefix="/upload")
MOST_FILES = 1_000
LOOKS_AGAIN_S = 2
NOTHING: Mapping[str, str] = MappingProxyType({})


@router.get("")
def form(request: Request, who: Owner) -> HTMLResponse:
    """The forms: one for files, and one for a measurement that is typed."""
    return _form(request, who, {}, None)


def _form(request: Request, who: Account, given: dict[str, str], fault: str | None) -> HTMLResponse:
    holder = holder_of(request, who)
    largest = state_of(request).settings.largest_upload_bytes
    status = 200 if fault is None else 422
    return page(
        request,
        "upload.html",
        status,
        given=given,
        preset={"recorded_at": f"{datetime.now(UTC):%Y-%m-%dT%H:%M}"},
        saved=saved(request),
        fault=None if fault is None else words_of(fault),
        largest=largest,
        most_files=MOST_FILES,
        waiting=MOST_OF_ACCOUNT,
        mine=mine_of(state_of(request).previews, holder),
    )


@router.post("")
async def send(request: Request, who: Owner) -> Response:
    """Read what was sent, and lead to what was understood; nothing is kept."""
    state = state_of(request)
    async with request.form(max_files=MOST_FILES, max_fields=10) as sent:
        if not any(isinstance(part, UploadFile) and part.filename for _, part in sent.multi_items()):
            return await run_in_threadpool(_form, request, who, {}, "No file was chosen.")
        preview = await run_in_threadpool(_read, state, who, holder_of(request, who), sent)
        if preview is None:
            raise gone()
    return RedirectResponse(f"/upload/{preview.id}", 303)


def _read(state: State, who: Account, holder: str, sent: FormData) -> Preview | None:
    """What waits now; None where newer ones took its place meanwhile."""
    preview = state.previews.new(holder, who.name or "")
    if preview is None:
        raise problem(503, "too many uploads wait to be kept; try again later", headers={"Retry-After": "600"})
    try:
        refused = save(_files(sent), preview.sent, state.settings.largest_unpacked_bytes)
        read(state.store, who, preview, refused)
        is_there = state.previews.admit(preview)
    except (OSError, ProblemError) as error:
        if preview.about() is not None:
            state.previews.drop(preview.id)
            raise
        _log.info("an upload was dropped, as newer ones took its place, while it was read: %s", error)
        is_there = False
    except BaseException:
        state.previews.drop(preview.id)
        raise
    if not is_there:
        state.previews.drop(preview.id)
    return preview if is_there else None


def _files(sent: FormData) -> Iterator[tuple[str, IO[bytes]]]:
    for _, part in sent.multi_items():
        if isinstance(part, UploadFile) and part.filename:
            yield part.filename, part.file


def _not_kept_yet(request: Request, who: Owner, id: str) -> Preview | None:
    """The one that waits; None where it was kept, or is being kept just now; else a 404."""
    previews, holder = state_of(request).previews, holder_of(request, who)
    found = previews.get(id, holder)
    if found is None and not previews.is_being_kept(id, holder) and previews.get_kept(id, holder) is None:
        raise gone()
    return found


NotKeptYet = Annotated[Preview | None, Depends(_not_kept_yet)]


@router.post("/one")
async def by_hand(request: Request, store: StoreOf, who: Owner) -> Response:
    """Keep a measurement that was typed."""
    fields = {name: value.strip() for name, value in (await form_of(request)).items()}
    try:
        receipt = await run_in_threadpool(_keep_typed, store, who, fields)
    except UnavailableError:
        raise
    except StoreError as error:
        return await run_in_threadpool(_form, request, who, fields, str(error))
    address = f"/recordings/{receipt.id}"
    return RedirectResponse(address if receipt.new else search(address, saved="again"), 303)


def _keep_typed(store: Store, who: Account, fields: Mapping[str, str]) -> Receipt:
    recording = recording_by_hand(fields, who)
    for entry in recording.entries:
        check_plausible(store, entry, who.viewer)
    return store.put(recording, uploader=who.name)


@router.get("/{id}")
def preview(request: Request, store: StoreOf, who: Owner, memory: Memory, id: str, waiting: NotKeptYet) -> Response:
    """What was understood; where it was kept meanwhile, what became of it."""
    if waiting is None:
        return _to_kept(id)
    return _shown(request, store, who, Allowance(memory=memory), waiting)


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
async def keep_all(
    request: Request, store: StoreOf, who: Owner, memory: Memory, id: str, waiting: NotKeptYet
) -> Response:
    """Keep what was shown, and lead to what became of it; once, also where the form is sent twice."""
    if waiting is not None:
        fields = await form_of(request)
        try:
            wishes = Wishes.of_form(fields)
        except StoreError as error:
            left = Allowance(memory=memory)
            return await run_in_threadpool(_shown, request, store, who, left, waiting, fields, words_of(str(error)))
        await run_in_threadpool(keep, state_of(request), who, waiting, wishes)
    return _to_kept(id)


def _to_kept(id: str) -> Response:
    return RedirectResponse(f"/upload/{id}/kept", 303)


@router.get("/{id}/kept")
def told(request: Request, store: StoreOf, who: Owner, id: str) -> Response:
    """What became of what was kept; while it is being kept the page looks again by itself."""
    previews, holder = state_of(request).previews, holder_of(request, who)
    if previews.is_being_kept(id, holder):
        found = page(request, "keeping.html")
        found.headers["Refresh"] = str(LOOKS_AGAIN_S)
        return found
    kept = previews.get_kept(id, holder)
    if kept is None:
        waiting_preview(request, who, id)
        return RedirectResponse(f"/upload/{id}", 303)
    return _told(request, store, who, kept)


def _told(request: Request, store: Store, who: Account, kept: Preview) -> HTMLResponse:
    outcomes = kept.kept()
    refused = [one for one in outcomes if one["fate"] == Fate.REFUSED.value]
    left = [one for one in outcomes if one["fate"] == Fate.SKIPPED.value]
    held = [one for one in outcomes if "told" in one and one not in refused]
    ids = recordings_of_digests(store, who.viewer, [one["digest"] for one in held if "digest" in one])
    there = [(one, ids[one["digest"]]) for one in held if one.get("digest") in ids]
    explored = [one for one in held if "episode" in one and episode_is_visible(store, who.viewer, UUID(one["episode"]))]
    return page(request, "kept.html", nothing=not outcomes, there=there, explored=explored, refused=refused, left=left)


@router.post("/{id}/cancel")
async def cancel(request: Request, who: Owner, waiting: Waiting) -> Response:
    """Forget what was sent."""
    check_same_site(request)
    await run_in_threadpool(state_of(request).previews.drop, waiting.id)
    return RedirectResponse(search("/upload", saved="cancelled"), 303)
