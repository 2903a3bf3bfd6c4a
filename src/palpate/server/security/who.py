"""Who asks: by a token, by the key of the person who started the server, or nobody in particular."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from hmac import compare_digest
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPBearer

from palpate.server.problems import problem
from palpate.server.security.accounts import HOST_NAME, Account, Role
from palpate.server.security.sites import check_same_site
from palpate.server.security.tokens import account_of, latest_end_us
from palpate.server.state import state_of

__all__ = ["COOKIE", "SESSION", "Who", "latest_end_of", "needs"]

COOKIE, SESSION = "palpate-key", "palpate-session"
TOKEN = HTTPBearer(scheme_name="token", description="A token of `palpate user token`.", auto_error=False)
"""For the document of the service: which operations need one."""


def account(request: Request) -> Account:
    """Who asks, and what they may do.

    A token that does not hold is an error also where none is needed: who sends one should learn that it has expired.
    """
    found = _account(request)
    # pages tell it
    request.state.account = found
    return found


def _account(request: Request) -> Account:
    scheme, _, secret = request.headers.get("authorization", "").partition(" ")
    if scheme:
        return _by_token(request, scheme, secret.strip())
    key, given = state_of(request).settings.key, request.cookies.get(COOKIE)
    if key is not None and given is not None and compare_digest(key.encode(), given.encode()):
        return Account(HOST_NAME, Role.ADMIN)
    session = request.cookies.get(SESSION)
    # a session that has ended is nobody's: the page says so by asking to log in
    return (account_of(state_of(request).store, session) if session else None) or Account()


Who = Annotated[Account, Depends(account)]


def latest_end_of(request: Request) -> int | None:
    """When a token that is made by this request ends at the latest, in microseconds; None where nothing limits it."""
    _, _, secret = request.headers.get("authorization", "").partition(" ")
    given = secret.strip() or request.cookies.get(SESSION, "")
    return latest_end_us(state_of(request).store, given, in_browser=not secret)


def needs(role: Role) -> Callable[..., Awaitable[Account]]:
    """A dependency that lets nobody with a lesser role do something."""

    # nothing waits here: a thread of its own would take longer than all of it
    async def checked(request: Request, who: Who, _: Annotated[object, Depends(TOKEN)]) -> Account:
        # a browser sends cookies along whoever has written the page
        if request.method not in ("GET", "HEAD") and "authorization" not in request.headers and request.cookies:
            check_same_site(request)
        if who.role is Role.NOBODY:
            raise problem(
                401, "a token is needed: send 'Authorization: Bearer ...'", headers={"WWW-Authenticate": "Bearer"}
            )
        if who.role < role:
            by = "this token is for" if "authorization" in request.headers else "your account is that of"
            raise problem(403, f"{by} {who.role.with_article}, expected {role.name.lower()} or more")
        return who

    return checked


def _by_token(request: Request, scheme: str, secret: str) -> Account:
    found = account_of(state_of(request).store, secret) if scheme.lower() == "bearer" else None
    if found is None:
        told = "the token is not known, has expired or was revoked"
        raise problem(401, told, headers={"WWW-Authenticate": 'Bearer error="invalid_token"'})
    return found
