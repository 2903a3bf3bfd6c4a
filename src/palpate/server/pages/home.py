"""The first page: what there is, what came last, and how to begin where there is nothing yet."""

from __future__ import annotations

from hmac import compare_digest
from uuid import UUID

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.example import add_example
from palpate.server.pages.templates import page
from palpate.server.problems import problem
from palpate.server.security.accounts import Role
from palpate.server.security.sites import check_same_site
from palpate.server.security.who import COOKIE, Who
from palpate.server.state import state_of
from palpate.store.counting import counted
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_setups import seen_properties
from palpate.store.visible_things import ThingFilter, list_visible_things

__all__ = ["router"]

router = APIRouter()
CARDS = 5
SIMULATED = ("simulated", "simulated-bench")
"""The data sets of which a page says that they are simulated."""


@router.get("/")
def home(request: Request, store: StoreOf, who: Who) -> HTMLResponse:
    """What there is in short."""
    viewer = who.viewer
    return page(
        request,
        "home.html",
        who=who,
        counts=counted(store, viewer),
        things=_some_things(store, viewer),
        recordings=list_recordings(store, VisibleFilter(viewer=viewer), limit=8).rows,
        episodes=list_episodes(store, viewer=viewer, limit=4).rows,
        properties=seen_properties(store, viewer),
        may_fill=who.role is Role.ADMIN,
    )


def _some_things(store: Store, viewer: Viewer) -> list[Thing]:
    """A few objects, those that were not simulated first."""
    real = list_visible_things(store, viewer, ThingFilter(in_none_of=SIMULATED), limit=CARDS).rows
    if len(real) == CARDS:
        return list(real)
    every = list_visible_things(store, viewer, limit=CARDS).rows
    paths = {one.path for one in real}
    return [*real, *(one for one in every if one.path not in paths)][:CARDS]


@router.get("/enter")
def enter(request: Request, key: str = "", episode: UUID | None = None) -> Response:
    """Know the browser of whoever started the server, by the key that was printed then; and show an exploration."""
    known = state_of(request).settings.key
    if known is None or not compare_digest(known.encode(), key.encode("utf-8", "replace")):
        raise problem(403, "key: is not the one that the server has printed")
    found = RedirectResponse("/" if episode is None else f"/episodes/{episode}", 303)
    found.set_cookie(COOKIE, known, httponly=True, samesite="strict", path="/")
    # the key stands in the address
    found.headers["Referrer-Policy"] = "no-referrer"
    return found


@router.post("/example")
def example(request: Request, store: StoreOf, who: Who) -> Response:
    """Fill an empty store with the example data."""
    check_same_site(request)
    if who.role is not Role.ADMIN:
        raise problem(403, "the example data is for administrators to add")
    add_example(store)
    return RedirectResponse("/", 303)
