"""Logging in and out with a browser."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.pages.templates import page
from palpate.server.problems import problem
from palpate.server.security.accounts import end, log_in
from palpate.server.security.rates import address_of
from palpate.server.security.sites import check_same_site, form_of
from palpate.server.security.who import COOKIE, SESSION, Who
from palpate.server.state import state_of

__all__ = ["router"]

router = APIRouter()


@router.get("/login")
def form(request: Request, who: Who) -> HTMLResponse:
    """The form to log in by."""
    return page(request, "login.html", wrong=False, name="")


@router.post("/login")
async def enter(request: Request, store: StoreOf) -> Response:
    """Log in: a new session, whatever the browser had before."""
    fields = await form_of(request)
    name, password = fields.get("name", ""), fields.get("password", "")
    _check_tries(request, name)
    secret = await run_in_threadpool(log_in, store, name, password)
    if secret is None:
        return page(request, "login.html", 403, wrong=True, name=name)
    found = RedirectResponse("/", 303)
    secure = state_of(request).settings.secure
    found.set_cookie(SESSION, secret, httponly=True, samesite="strict", path="/", secure=secure)
    return found


@router.post("/logout")
def leave(request: Request, store: StoreOf) -> Response:
    """Log out: the session ends here and on the server."""
    check_same_site(request)
    session = request.cookies.get(SESSION)
    if session:
        end(store, session)
    found = RedirectResponse("/", 303)
    for cookie in (SESSION, COOKIE):
        found.delete_cookie(cookie, path="/", httponly=True, samesite="strict")
    return found


def _check_tries(request: Request, name: str) -> None:
    """Refuse to try more passwords: of one account, and from one address."""
    state = state_of(request)
    waits = (state.tries_of_address.wait_s(address_of(request)), state.tries_of_name.wait_s(name))
    if any(waits):
        told = "too many tries to log in; wait a little"
        raise problem(429, told, headers={"Retry-After": str(int(max(waits)) + 1)})
