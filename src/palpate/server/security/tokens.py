"""Tokens, by which programs and browsers say whose they are.

A token is random and shown once; a store keeps its SHA-256 only, which cannot be guessed as there is nothing to guess
from. What a token may do is the lesser of its own role and its account's.
"""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from hashlib import sha256
from typing import Any

from sqlalchemy import Connection, Select, bindparam, func, insert, or_, select, update

from palpate.server.security.accounts import Account, Role, no_account
from palpate.server.security.lifetimes import MICROSECONDS_PER_DAY, SESSION_US, is_of_session, lasts_as_session
from palpate.store import schema
from palpate.store.database import asking, changing
from palpate.store.errors import StoreError
from palpate.store.registry import now_us
from palpate.store.rows import moment_at
from palpate.store.store import Store

__all__ = [
    "MadeAlreadyError",
    "Token",
    "account_of",
    "end",
    "issue",
    "issue_session",
    "latest_end_us",
    "number_of",
    "revoke",
    "tokens",
]

PREFIX = "palpate_"
"""Begins each token, so that one that was published by mistake can be found."""


@dataclass(frozen=True)
class Token:
    """A token as it stands in a list: without the secret, which nobody has but its owner."""

    id: int
    user: str
    role: str
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    is_session: bool

    @property
    def holds(self) -> bool:
        """Whether it lets anybody in now."""
        return self.revoked_at is None and (self.expires_at is None or self.expires_at > moment_at(now_us()))


class MadeAlreadyError(StoreError):
    """A token was made since somebody looked at which there are, as by the same form."""


def issue(
    store: Store,
    name: str,
    role: Role | None = None,
    *,
    days: float | None = 365.0,
    until_us: int | None = None,
    last: int | None = None,
) -> str:
    """Make a token for an account.

    Parameters
    ----------
    role
        What it may do at most; all that the account may unless given.
    days
        After how many it expires; never where it is None.
    until_us
        When it expires at the latest.
    last
        Number of the last token of the account, as somebody has seen it: whichever it is unless given.

    Returns
    -------
    str
        The token, which nobody can tell again.

    Raises
    ------
    StoreError
        If there is no such account, or the role is more than it has.
    MadeAlreadyError
        If the account has a later token than the `last` one.
    """
    if days is not None and not 0 < days <= 36_500:
        raise StoreError(f"days: found {days:g}, expected more than 0 and 36500 at most")
    with changing(store.engine) as connection:
        row = _locked_account(connection, name)
        own = Role.parse(row.role)
        if role is not None and role > own:
            raise StoreError(f"role: {name!r} is {row.role}, expected a token for that or less")
        if last is not None:
            _check_last(connection, row.id, last)
        now = now_us()
        expires = None if days is None else now + int(days * MICROSECONDS_PER_DAY)
        until = min((one for one in (expires, until_us) if one is not None), default=None)
        if until is not None and lasts_as_session(now, until):
            # it would be taken for one
            until -= 1
        return _insert(connection, row.id, role or own, now, until)


def issue_session(store: Store, name: str) -> str:
    """What a browser gets where somebody logs in: a token for all that the account may, for half a day."""
    with changing(store.engine) as connection:
        row, now = _locked_account(connection, name), now_us()
        return _insert(connection, row.id, Role.parse(row.role), now, now + SESSION_US)


def _locked_account(connection: Connection, name: str) -> Any:
    """Number and role of an account, whose tokens nobody else makes until this ends."""
    columns = schema.users.c
    row = connection.execute(select(columns.id, columns.role).where(columns.name == name).with_for_update()).first()
    if row is None:
        raise no_account(name)
    return row


def _check_last(connection: Connection, account: int, last: int) -> None:
    columns = schema.tokens.c
    later = select(func.max(columns.id)).where(columns.user_id == account, columns.id > last, ~is_of_session())
    found = connection.scalar(later)
    if found is not None:
        raise MadeAlreadyError(
            f"Token {found} was made since this form was shown, as by sending it before; its secret was shown then, and"
            " nobody can tell it again. Where it is lost, end that one and make another"
        )


def _insert(connection: Connection, account: int, role: Role, now: int, until: int | None) -> str:
    secret = PREFIX + secrets.token_urlsafe(32)
    token = {"user_id": account, "digest": digest_of(secret), "role": role.name.lower(), "created_us": now}
    connection.execute(insert(schema.tokens).values(**token, expires_us=until))
    return secret


def end(store: Store, secret: str) -> None:
    """End a token by itself, as when somebody logs out; nothing happens where it has ended."""
    columns = schema.tokens.c
    holds = (columns.digest == digest_of(secret), columns.revoked_us.is_(None))
    with changing(store.engine) as connection:
        connection.execute(update(schema.tokens).where(*holds).values(revoked_us=now_us()))


def revoke(store: Store, token: int, *, user: str | None = None, most: Role = Role.ADMIN) -> None:
    """End a token at once; `user`: only where it is theirs, `most`: only where it may do no more than this.

    Raises
    ------
    StoreError
        If there is none that holds.
    """
    columns = schema.tokens.c
    condition = (columns.id == token) & columns.revoked_us.is_(None)
    if user is not None:
        condition &= columns.user_id.in_(select(schema.users.c.id).where(schema.users.c.name == user))
    names = [role.name.lower() for role in Role if role <= most]
    # a token does the lesser of its own role and its account's
    held = select(schema.users.c.id).where(schema.users.c.role.in_(names))
    condition &= or_(columns.role.in_(names), columns.user_id.in_(held))
    with changing(store.engine) as connection:
        done = connection.execute(update(schema.tokens).where(condition).values(revoked_us=now_us()))
        if not done.rowcount:
            raise StoreError(f"token {token}: there is none that holds, expected one of the list of tokens")


def account_of(store: Store, secret: str) -> Account | None:
    """Whose token it is; None where it is nobody's, has expired or was revoked."""
    with asking(store.engine) as connection:
        row = connection.execute(_holder(), {"digest": digest_of(secret)}).first()
    if row is None or (row.expires_us is not None and row.expires_us <= now_us()):
        return None
    return Account(row.name, min(Role.parse(row.role), Role.parse(row.scope)))


@cache
def _holder() -> Select[*tuple[Any, ...]]:
    """The question whose a token is; nearly every request asks it, and putting it together takes longer than asking."""
    users_, tokens_ = schema.users.c, schema.tokens.c
    return (
        select(users_.name, users_.role, tokens_.role.label("scope"), tokens_.expires_us)
        .join(schema.users, users_.id == tokens_.user_id)
        .where(tokens_.digest == bindparam("digest"), tokens_.revoked_us.is_(None))
    )


def tokens(store: Store, user: str | None = None) -> tuple[Token, ...]:
    """All tokens, or those of one account, the first first; those that were revoked too."""
    columns = schema.tokens.c
    asked = select(schema.tokens, schema.users.c.name).join(schema.users, schema.users.c.id == columns.user_id)
    if user is not None:
        asked = asked.where(schema.users.c.name == user)
    with asking(store.engine) as connection:
        return tuple(_token(row) for row in connection.execute(asked.order_by(columns.id)))


def latest_end_us(store: Store, secret: str, *, in_browser: bool) -> int | None:
    """When what is made by a token ends at the latest: with it; None where it may last as long as somebody likes.

    Who has logged in with a browser makes tokens that last, which is what the page of an account is for. A session of a
    log-in lasts exactly as long as all of them: another short token, sent as if it were one, is none.
    """
    columns = schema.tokens.c
    with asking(store.engine) as connection:
        asked = select(columns.created_us, columns.expires_us).where(columns.digest == digest_of(secret))
        row = connection.execute(asked).first()
    if row is None or row.expires_us is None:
        return None
    is_log_in = in_browser and lasts_as_session(row.created_us, row.expires_us)
    return None if is_log_in else int(row.expires_us)


def digest_of(secret: str) -> bytes:
    """What a store keeps of a token."""
    return sha256(secret.encode("utf-8", "surrogateescape")).digest()


def _token(row: Any) -> Token:
    expires_at, revoked_at = (None if us is None else moment_at(us) for us in (row.expires_us, row.revoked_us))
    is_session = lasts_as_session(row.created_us, row.expires_us)
    return Token(row.id, row.name, row.role, moment_at(row.created_us), expires_at, revoked_at, is_session)


def number_of(store: Store, secret: str) -> int | None:
    """The number of a token in the list of them; None where there is none."""
    columns = schema.tokens.c
    with asking(store.engine) as connection:
        return connection.scalar(select(columns.id).where(columns.digest == digest_of(secret)))
