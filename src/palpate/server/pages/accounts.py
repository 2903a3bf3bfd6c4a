"""One's own account: password, tokens and sessions; and for administrators all accounts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from fastapi import APIRouter, Depends, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.pages.sessions import begin_session
from palpate.server.pages.templates import page
from palpate.server.problems import problem
from palpate.server.security.accounts import Account, Role, has_account, users
from palpate.server.security.lifetimes import SESSION_DAYS
from palpate.server.security.managing import Accounts
from palpate.server.security.sites import form_of
from palpate.server.security.tokens import MadeAlreadyError, issue_session, number_of, tokens
from palpate.server.security.who import SESSION, latest_end_of, needs
from palpate.server.state import state_of
from palpate.server.typed_entries import typed_number
from palpate.store.errors import StoreError, UnavailableError

__all__ = ["router"]

router = APIRouter()
Somebody = Annotated[Account, Depends(needs(Role.READER))]
Administrator = Annotated[Account, Depends(needs(Role.ADMIN))]
Fields = Mapping[str, str]
ROLES = tuple(role for role in Role if role is not Role.NOBODY)


@router.get("/account")
def own(request: Request, store: StoreOf, who: Somebody) -> HTMLResponse:
    """Who somebody is here, with what they may do about it."""
    return _own(request, Accounts(store, who))


@router.post("/account")
async def change_own(request: Request, store: StoreOf, who: Somebody) -> Response:
    """Do what the button of one of the forms says."""
    accounts, fields = Accounts(store, who), await form_of(request)
    do = _one_of(fields, "password", "token", "end")
    try:
        if do == "password":
            return await _change_password(request, accounts, fields)
        if do == "token":
            role = Role.parse(fields.get("role", ""))
            until_us = await run_in_threadpool(latest_end_of, request)
            last = _number(fields, "last") if "last" in fields else None
            secret = await run_in_threadpool(accounts.make_token, role, _days(fields), until_us, last)
            return await run_in_threadpool(_own, request, accounts, secret=secret)
        await run_in_threadpool(accounts.end_token, _number(fields))
    except UnavailableError:
        raise
    except StoreError as error:
        status = 409 if isinstance(error, MadeAlreadyError) else 422
        return await run_in_threadpool(_own, request, accounts, status, fault=str(error))
    return RedirectResponse("/account", 303)


async def _change_password(request: Request, accounts: Accounts, fields: Fields) -> Response:
    if fields.get("new") != fields.get("again"):
        raise StoreError("new password: the second time it is another one")
    # whoever finds a browser that is logged in could guess here as well as at the log-in
    state_of(request).tries.count(request, accounts.name)
    await run_in_threadpool(accounts.change_password, fields.get("old", ""), fields.get("new", ""))
    found = RedirectResponse("/account?saved=password", 303)
    # the session of this browser has ended with the others
    secret = await run_in_threadpool(issue_session, accounts.store, accounts.name)
    begin_session(found, secret, secure=state_of(request).settings.secure)
    return found


def _own(
    request: Request, accounts: Accounts, status: int = 200, *, fault: str | None = None, secret: str | None = None
) -> HTMLResponse:
    every = tokens(accounts.store, accounts.name)
    held = [one for one in every if one.holds]
    return page(
        request,
        "account.html",
        status,
        fault=fault,
        secret=secret,
        changed=request.query_params.get("saved") == "password",
        role=accounts.who.role.with_article,
        roles=[role.name.lower() for role in ROLES if role <= accounts.who.role],
        last=max((one.id for one in every if not one.is_session), default=0),
        programs=[one for one in held if not one.is_session],
        sessions=[one for one in held if one.is_session],
        here=number_of(accounts.store, request.cookies.get(SESSION, "")),
        is_admin=accounts.who.role is Role.ADMIN,
        has_account=has_account(accounts.store, accounts.who.name),
    )


@router.get("/users")
def every(request: Request, store: StoreOf, who: Administrator) -> HTMLResponse:
    """All accounts, for administrators."""
    return _every(request, Accounts(store, who))


@router.post("/users")
async def change_any(request: Request, store: StoreOf, who: Administrator) -> Response:
    """Do what the button of one of the forms says."""
    accounts, fields = Accounts(store, who), {name: text.strip() for name, text in (await form_of(request)).items()}
    do, name = _one_of(fields, "add", "role", "password", "end"), fields.get("name", "")
    try:
        if do in ("add", "password"):
            password = await run_in_threadpool(_told_password, accounts, do, name, fields)
            return await run_in_threadpool(_every, request, accounts, told=(name, password))
        if do == "role":
            await run_in_threadpool(accounts.set_role, name, Role.parse(fields.get("role", "")))
        else:
            await run_in_threadpool(accounts.end_token, _number(fields))
    except UnavailableError:
        raise
    except StoreError as error:
        return await run_in_threadpool(_every, request, accounts, fault=str(error), given=fields)
    return RedirectResponse("/users", 303)


def _told_password(accounts: Accounts, do: str, name: str, fields: Fields) -> str:
    if do == "password":
        return accounts.give_password(name)
    return accounts.add(name, Role.parse(fields.get("role", "")), fields.get("email") or None)


def _every(
    request: Request,
    accounts: Accounts,
    *,
    fault: str | None = None,
    told: tuple[str, str] | None = None,
    given: Fields | None = None,
) -> HTMLResponse:
    held: dict[str, list[object]] = {}
    for one in tokens(accounts.store):
        if one.holds:
            held.setdefault(one.user, []).append(one)
    return page(
        request,
        "users.html",
        200 if fault is None else 422,
        fault=fault,
        told=told,
        given=given or {},
        users=users(accounts.store),
        held=held,
        roles=[role.name.lower() for role in ROLES],
    )


def _one_of(fields: Fields, *acts: str) -> str:
    found = fields.get("do", "")
    if found not in acts:
        raise problem(422, f"do: found {found[:40]!r}, expected one of {', '.join(acts)}")
    return found


def _days(fields: Fields) -> float:
    found = typed_number("days", fields.get("days", ""))
    if not SESSION_DAYS < found <= 36_500:
        raise StoreError(f"days: found {found:g}, expected more than {SESSION_DAYS:g} and 36500 at most")
    return found


def _number(fields: Fields, name: str = "number") -> int:
    text = fields.get(name, "")
    if not (text.isascii() and text.isdigit() and len(text) < 16):
        raise StoreError(f"{name}: found {text[:40]!r}, expected that of a token")
    return int(text)
