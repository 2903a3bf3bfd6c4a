"""Who asks by HTTP Basic, as scripts of the old program do: a name with its password, or with a token in its place."""

from __future__ import annotations

import base64
import binascii
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy import select

from palpate.server.problems import ProblemError, problem
from palpate.server.security.accounts import Account, Role
from palpate.server.security.addresses import is_here
from palpate.server.security.passwords import is_password
from palpate.server.security.sites import check_same_site
from palpate.server.security.tokens import account_of
from palpate.server.state import state_of
from palpate.store import schema
from palpate.store.database import asking
from palpate.store.store import Store

__all__ = ["BasicOwner"]

CHALLENGE = {"WWW-Authenticate": 'Basic realm="Palpate", charset="UTF-8"'}
IN_THE_CLEAR = (
    "the name and password came over a connection that anybody on the way can read, and nothing was done: send them to "
    "https://, and change the password"
)


def basic_owner(request: Request) -> Account:
    """An account that may upload; nothing is looked at where the password could be overheard on its way."""
    if request.url.scheme != "https" and not is_here(request, proxied=state_of(request).settings.proxied):
        raise problem(403, IN_THE_CLEAR)
    if "origin" in request.headers:
        # a browser that knows a password sends it along whoever has written the page
        check_same_site(request)
    name, secret = _given(request)
    who = _found(request, name, secret)
    if who.role < Role.OWNER:
        raise problem(403, f"this account is {who.role.with_article}, expected owner or more")
    return who


BasicOwner = Annotated[Account, Depends(basic_owner)]


def _given(request: Request) -> tuple[str, str]:
    scheme, _, encoded = request.headers.get("authorization", "").partition(" ")
    if scheme.lower() != "basic":
        raise _refused("a name and a password are needed, by HTTP Basic; a token may stand in the password's place")
    try:
        given = base64.b64decode(encoded.strip(), validate=True)
    except (ValueError, binascii.Error):
        raise _refused("authorization: is no HTTP Basic") from None
    try:
        text = given.decode()
    except UnicodeDecodeError:
        # as libraries of that time send it
        text = given.decode("latin-1")
    name, _, secret = text.partition(":")
    return name, secret


def _found(request: Request, name: str, secret: str) -> Account:
    """The account; what succeeds is not counted in the end, as each upload of many logs in again."""
    state = state_of(request)
    by_token = account_of(state.store, secret)
    if by_token is not None and by_token.name == name:
        return by_token
    state.tries.count(request, name)
    found = _by_password(state.store, name, secret)
    if found is None:
        raise _refused("the name or the password is wrong")
    state.tries.give_back(request, name)
    return found


def _by_password(store: Store, name: str, password: str) -> Account | None:
    columns = schema.users.c
    with asking(store.engine) as connection:
        row = connection.execute(select(columns.role, columns.password_hash).where(columns.name == name)).first()
    # as slow where there is no account
    is_right = is_password(password, None if row is None else row.password_hash)
    return Account(name, Role.parse(row.role)) if is_right and row is not None else None


def _refused(told: str) -> ProblemError:
    return problem(401, told, headers=CHALLENGE)
