"""Accounts and tokens: one's own, and for administrators all."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Request
from fastapi.responses import Response

from palpate.server.api.answers import answer
from palpate.server.api.models import NewToken, Page, Token, TokenAsked, User
from palpate.server.api.parameters import Place, StoreOf
from palpate.server.api.plain import moment
from palpate.server.problems import problem
from palpate.server.security import accounts, tokens
from palpate.server.security.accounts import Account, Role
from palpate.server.security.managing import Accounts
from palpate.server.security.who import latest_end_of, needs
from palpate.store.errors import StoreError, UnavailableError

__all__ = ["router"]

router = APIRouter(tags=["users"])
Somebody = Annotated[Account, Depends(needs(Role.READER))]
Administrator = Annotated[Account, Depends(needs(Role.ADMIN))]


@router.get("/users", response_model=Page[User])
def list_users(store: StoreOf, _: Administrator) -> Response:
    """All accounts."""
    items = [{**vars(one), "created_at": moment(one.created_at)} for one in accounts.users(store)]
    return answer({"items": items, "next": None})


@router.get("/tokens", response_model=Page[Token])
def list_tokens(store: StoreOf, who: Somebody) -> Response:
    """One's own tokens, without their secrets; for administrators all."""
    found = tokens.tokens(store, None if who.role is Role.ADMIN else who.name)
    items = [{**vars(one), **{name: moment(getattr(one, name)) for name in MOMENTS}} for one in found]
    return answer({"items": items, "next": None})


@router.post("/tokens", response_model=NewToken, status_code=201)
def make_token(request: Request, store: StoreOf, who: Somebody, asked: TokenAsked) -> Response:
    """Make a token of one's own, which may do no more than the one that asks and ends no later; told this once."""
    role = None if asked.role is None else Role.parse(asked.role)
    return answer({"token": Accounts(store, who).make_token(role, asked.days, latest_end_of(request))}, 201)


@router.delete("/tokens/{id}", status_code=204)
def revoke_token(store: StoreOf, who: Somebody, id: Place) -> Response:
    """End a token at once: one of one's own that may do no more than this one, or as an administrator any."""
    try:
        Accounts(store, who).end_token(id)
    except UnavailableError:
        raise
    except StoreError as error:
        raise problem(404, str(error)) from None
    return Response(status_code=204)


MOMENTS = ("created_at", "expires_at", "revoked_at")
