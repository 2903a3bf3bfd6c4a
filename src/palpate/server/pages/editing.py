"""Changing what is said of an object, by forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated

from fastapi import APIRouter, Depends, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from palpate.server.api.parameters import SeenThing, StoreOf, seen_thing
from palpate.server.corrections import Corrections
from palpate.server.pages.templates import page, search
from palpate.server.problems import ProblemError, problem
from palpate.server.security.accounts import Account, Role
from palpate.server.security.sites import form_of
from palpate.server.security.who import needs
from palpate.server.typed_entries import typed_entry
from palpate.server.uploading.form_words import words_of
from palpate.store.changing_seen import version_of
from palpate.store.errors import StoreError, UnavailableError

__all__ = ["router"]

router = APIRouter(prefix="/objects/{dataset}/{name}/edit")
Owner = Annotated[Account, Depends(needs(Role.OWNER))]
Fields = Mapping[str, str]


@router.get("")
def forms(request: Request, store: StoreOf, who: Owner, thing: SeenThing) -> HTMLResponse:
    """All forms, and who changed what before."""
    return _page(request, Corrections(store, who, thing), {}, None)


@router.post("")
async def change(request: Request, store: StoreOf, who: Owner, thing: SeenThing) -> Response:
    """Do what the button of one of the forms says."""
    fields = {name: value.strip() for name, value in (await form_of(request)).items()}
    corrections = Corrections(store, who, thing)
    act = ACTS.get(fields.get("do", ""))
    if act is None:
        raise problem(422, f"do: found {fields.get('do', '')[:40]!r}, expected one of {', '.join(ACTS)}")
    try:
        await run_in_threadpool(act, corrections, fields)
    except UnavailableError:
        raise
    except (StoreError, ProblemError) as error:
        told = error.detail if isinstance(error, ProblemError) else str(error)
        status = error.status_code if isinstance(error, ProblemError) else 422
        if status == 409:
            # what was typed stays, beside what holds by now
            thing = await run_in_threadpool(seen_thing, store, who, thing.ref.dataset, thing.ref.id)
            corrections = Corrections(store, who, thing)
        elif status not in (403, 422):
            raise
        return await run_in_threadpool(_page, request, corrections, fields, words_of(told), status)
    return RedirectResponse(search(request.url.path.removesuffix("/edit"), saved=_saved(corrections, fields)), 303)


def _saved(corrections: Corrections, fields: Fields) -> str:
    """The word for what was done, by what was known before it."""
    told = fields["do"], fields.get("property", ""), fields.get("source", "")
    before = {("know", one.entry.property, one.source) for one in corrections.thing.known}
    return "replaced" if told in before else fields["do"]


def _page(
    request: Request, corrections: Corrections, given: Fields, fault: str | None, status: int = 200
) -> HTMLResponse:
    thing = corrections.thing
    told = {"history": corrections.history()[:30], "last": corrections.last(), "thing_version": version_of(thing)}
    return page(request, "edit.html", status, None, thing=thing, given=given, fault=fault, **told)


def _describe(corrections: Corrections, fields: Fields) -> None:
    aliases = [one.strip() for one in fields.get("aliases", "").splitlines()]
    corrections.describe(
        {
            "common_name": fields.get("common_name") or None,
            "maker": fields.get("maker") or None,
            "aliases": tuple(one for one in aliases if one),
        },
        fields.get("version"),
    )


def _know(corrections: Corrections, fields: Fields) -> None:
    corrections.know(typed_entry(fields), fields.get("source", ""))


def _forget(corrections: Corrections, fields: Fields) -> None:
    corrections.forget(fields.get("property", ""), fields.get("source") or None)


def _merge(corrections: Corrections, fields: Fields) -> None:
    into = fields.get("into", "")
    dataset, _, name = into.partition("/")
    if not dataset or not name:
        raise problem(422, f"into: found {into[:80]!r}, expected DATASET/NAME, such as ycb/025_mug")
    corrections.merge(dataset, name, shows_name=fields.get("shows_name") == "yes")


ACTS: Mapping[str, Callable[[Corrections, Fields], object]] = {
    "describe": _describe,
    "know": _know,
    "forget": _forget,
    "merge": _merge,
    "split": lambda corrections, _: corrections.split(),
    "undo": lambda corrections, _: corrections.undo(),
}
