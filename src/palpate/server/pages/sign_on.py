"""Logging in by an OpenID provider, with a browser."""

from __future__ import annotations

import logging
from hmac import compare_digest
from urllib.parse import quote

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.pages.sessions import begin_session
from palpate.server.pages.templates import page
from palpate.server.problems import problem
from palpate.server.security.asking import AwayError, SignOnError
from palpate.server.security.identities import UnknownPersonError, account_name
from palpate.server.security.returns import log_in_for, own_path
from palpate.server.security.single_sign_on import Attempt, Provider
from palpate.server.security.tokens import issue_session
from palpate.server.state import state_of
from palpate.store.store import Store
from palpate.store.unpadded import from_unpadded, to_unpadded

__all__ = ["router"]

router = APIRouter(prefix="/login/provider")
COOKIE = "palpate-attempt"
PATH = "/login/provider"
BACK = f"{PATH}/back"
ATTEMPT_S = 600
_log = logging.getLogger("palpate.server")


@router.get("")
def leave(request: Request) -> Response:
    """Send a browser to the provider, and leave in it what its answer is known by."""
    provider, attempt = _provider(request), Attempt.new()
    next = own_path(request.query_params.get("next", "/"))
    state_of(request).tries.count(request, PATH)
    try:
        found = RedirectResponse(provider.address(attempt, _back(request)), 303)
    except SignOnError as error:
        _log.error("%s: %s", provider.issuer, error)
        return _refused(request, error, 502, next)
    value = ".".join((attempt.state, attempt.nonce, attempt.verifier, _hidden(next)))
    secure = state_of(request).settings.secure
    # the provider sends the browser back from elsewhere, where a strict cookie would stay behind
    found.set_cookie(COOKIE, value, ATTEMPT_S, path=PATH, httponly=True, samesite="lax", secure=secure)
    return found


@router.get("/back")
async def come_back(request: Request, store: StoreOf) -> Response:
    """Log in who the provider says it is; a page, as a browser that comes from elsewhere would not send the session."""
    provider = _provider(request)
    attempt, next = _attempt(request)
    state_of(request).tries.count(request, BACK)
    try:
        name = await run_in_threadpool(_name, request, store, provider, attempt)
        secret = await run_in_threadpool(issue_session, store, name)
        found: Response = page(request, "sign_on.html", told=None, name=name, next=next)
        begin_session(found, secret, secure=state_of(request).settings.secure)
    except (SignOnError, UnknownPersonError) as error:
        _log.warning("%s: %s", provider.issuer, error)
        found = _refused(request, error, 403, next)
    # the answer to one question is taken once
    found.delete_cookie(COOKIE, path=PATH, httponly=True, samesite="lax")
    return found


def _refused(request: Request, error: SignOnError | UnknownPersonError, status: int, next: str) -> Response:
    """The page of who is not logged in; where the provider is away, it says when to try again."""
    headers = {"Retry-After": str(int(error.retry_s) + 1)} if isinstance(error, AwayError) else None
    again = log_in_for(next)
    return page(request, "sign_on.html", 503 if headers else status, headers, told=str(error), again=again)


def _name(request: Request, store: Store, provider: Provider, attempt: Attempt | None) -> str:
    given = request.query_params
    if attempt is None or not compare_digest(given.get("state", "").encode(), attempt.state.encode()):
        raise SignOnError("this is no answer to a log-in that this browser has begun; begin again")
    if given.get("iss", provider.issuer) != provider.issuer:
        raise SignOnError("this is the answer of another provider")
    code = given.get("code")
    if not code:
        raise SignOnError("the provider has logged nobody in")
    who = provider.identity(attempt, _back(request), code)
    return account_name(store, who, new_readers=state_of(request).settings.oidc_new_readers)


def _attempt(request: Request) -> tuple[Attempt | None, str]:
    """What the browser has kept: by what the answer is known, and the page that somebody comes from."""
    parts = request.cookies.get(COOKIE, "").split(".")
    if len(parts) != 4 or not all(parts):
        return None, "/"
    return Attempt(*parts[:3]), own_path(_shown(parts[3]))


def _hidden(path: str) -> str:
    """A path as a cookie can hold it, without a full stop."""
    return to_unpadded(path.encode())


def _shown(hidden: str) -> str:
    """The path that `_hidden` was given; none where somebody else has written it."""
    try:
        return from_unpadded(hidden).decode()
    except ValueError:
        return ""


def _provider(request: Request) -> Provider:
    found = state_of(request).provider
    if found is None:
        raise problem(404, "this server logs in by name and password only")
    return found


def _back(request: Request) -> str:
    """Where the provider sends a browser back to; it knows the address, and sends it to no other."""
    scheme = "https" if state_of(request).settings.secure else request.url.scheme
    return f"{scheme}://{quote(request.headers.get('host', ''), safe=':[].-')}{BACK}"
