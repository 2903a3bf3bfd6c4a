"""Logging in and out with a browser."""

from __future__ import annotations

from typing import Any
from urllib.parse import urlsplit

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.pages.templates import page
from palpate.server.pages.typed import Typed, send_again_page
from palpate.server.security.accounts import Account
from palpate.server.security.logging_in import log_in
from palpate.server.security.returns import log_in_for, own_path
from palpate.server.security.sites import check_same_site, form_of
from palpate.server.security.tokens import account_of, end
from palpate.server.security.who import COOKIE, SESSION, Who
from palpate.server.state import state_of

__all__ = ["begin_session", "log_in_form", "router"]

router = APIRouter()


@router.get("/login")
def form(request: Request, who: Who) -> HTMLResponse:
    """The form to log in by."""
    return log_in_form(request, 200, next=request.query_params.get("next", "/"))


@router.post("/login")
async def enter(request: Request, store: StoreOf) -> Response:
    """Log in: a new session, whatever the browser had before; and back to the page that asked for it.

    Who had typed something into a form, which was not taken as the session had ended, can send it now.
    """
    fields = await form_of(request)
    name, password, next = fields.get("name", ""), fields.get("password", ""), fields.get("next", "/")
    typed = Typed.parse(fields.get("typed", ""))
    # before it is known whether it is the right one, as others may be under way
    state_of(request).tries.count(request, name)
    secret = await run_in_threadpool(log_in, store, name, password)
    if secret is None:
        return log_in_form(request, 403, wrong=True, name=name, next=next, typed=typed)
    request.state.account = await run_in_threadpool(account_of, store, secret) or Account()
    found: Response = RedirectResponse(own_path(next), 303) if typed is None else send_again_page(request, typed)
    begin_session(found, secret, secure=state_of(request).settings.secure)
    return found


def begin_session(found: Response, secret: str, *, secure: bool) -> None:
    """Leave a session in a browser, which neither scripts nor other sites get at; whatever it had before is gone."""
    found.set_cookie(SESSION, secret, httponly=True, samesite="strict", path="/", secure=secure)


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


def log_in_form(
    request: Request, status: int, *, wrong: bool = False, name: str = "", next: str = "/", typed: Typed | None = None
) -> HTMLResponse:
    """The page with the form to log in by, and with what was typed into another one meanwhile."""
    provider = state_of(request).provider
    host = None if provider is None else urlsplit(provider.issuer).hostname
    back = own_path(next)
    by_provider = log_in_for(back, "/login/provider")
    told: dict[str, Any] = {
        "wrong": wrong,
        "name": name,
        "provider": host,
        "by_provider": by_provider,
        "next": back,
        "typed": typed,
        "contact": state_of(request).settings.contact,
    }
    return page(request, "login.html", status, **told)
