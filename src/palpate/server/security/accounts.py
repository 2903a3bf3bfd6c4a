"""Accounts and their tokens: who may do what with a store over the network.

A token is random and shown once; a store keeps its SHA-256 only, which cannot be guessed as there is nothing to guess
from. What a token may do is the lesser of its own role and its account's.
"""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import IntEnum
from functools import cache
from hashlib import sha256
from typing import Any

from sqlalchemy import Select, bindparam, insert, select, update

from palpate.errors import choices
from palpate.server.security.passwords import hashed, is_password
from palpate.store import schema
from palpate.store.database import changing
from palpate.store.errors import StoreError
from palpate.store.registry import now_us
from palpate.store.rows import EPOCH
from palpate.store.store import Store
from palpate.store.texts import check_name
from palpate.store.viewing import Viewer

__all__ = [
    "Account",
    "Role",
    "Token",
    "User",
    "account_of",
    "add_user",
    "end",
    "issue",
    "log_in",
    "revoke",
    "set_password",
    "set_role",
    "tokens",
    "users",
]

PREFIX = "palpate_"
"""Begins each token, so that one that was published by mistake can be found."""
SESSION_DAYS = 0.5
MICROSECONDS_PER_DAY = 86_400_000_000


class Role(IntEnum):
    """What somebody may do; each may do what those before it may.

    A reader sees what is shared in the lab; an owner uploads, and changes what is theirs; a curator changes objects; an
    administrator sees all and has accounts.
    """

    NOBODY = 0
    READER = 1
    OWNER = 2
    CURATOR = 3
    ADMIN = 4

    @classmethod
    def parse(cls, text: str) -> Role:
        """The role of a name.

        Raises
        ------
        StoreError
            If there is none.

        Examples
        --------
        >>> Role.parse("curator") > Role.OWNER
        True
        """
        names = {role.name.lower(): role for role in cls if role is not cls.NOBODY}
        if text not in names:
            raise StoreError(f"role: found {text!r}; {choices(names)}")
        return names[text]


@dataclass(frozen=True)
class Account:
    """Who asks, and what they may do now."""

    name: str | None = None
    role: Role = Role.NOBODY

    @property
    def viewer(self) -> Viewer:
        """What they see."""
        return Viewer(self.name, lab=self.role >= Role.READER, everything=self.role >= Role.ADMIN)


@dataclass(frozen=True)
class User:
    """An account as it stands in a list."""

    name: str
    role: str
    email: str | None
    created_at: datetime
    tokens: int


@dataclass(frozen=True)
class Token:
    """A token as it stands in a list: without the secret, which nobody has but its owner."""

    id: int
    user: str
    role: str
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None


def add_user(store: Store, name: str, role: Role, email: str | None = None) -> None:
    """Make an account.

    Parameters
    ----------
    name
        Also the name under which their recordings are owned.

    Raises
    ------
    StoreError
        If the name is taken, or cannot be one.
    """
    check_name("name", name)
    if name != name.strip() or any(not letter.isprintable() for letter in name):
        raise StoreError(f"name: found {name!r}, expected one without spaces around it, all of it printable")
    columns = schema.users.c
    with changing(store.engine) as connection:
        if connection.scalar(select(columns.id).where(columns.name == name)) is not None:
            raise StoreError(f"name: {name!r} has an account, expected another one")
        row = {"name": name, "role": role.name.lower(), "email": email, "created_us": now_us()}
        connection.execute(insert(schema.users).values(**row))


def set_role(store: Store, name: str, role: Role) -> None:
    """Let an account do more or less; its tokens with it."""
    columns = schema.users.c
    with changing(store.engine) as connection:
        done = connection.execute(update(schema.users).where(columns.name == name).values(role=role.name.lower()))
        if not done.rowcount:
            raise _no_account(name)


def issue(store: Store, name: str, role: Role | None = None, *, days: float | None = 365.0) -> str:
    """Make a token for an account.

    Parameters
    ----------
    role
        What it may do at most; all that the account may unless given.
    days
        After how many it expires; never where it is None.

    Returns
    -------
    str
        The token, which nobody can tell again.

    Raises
    ------
    StoreError
        If there is no such account, or the role is more than it has.
    """
    if days is not None and not 0 < days <= 36_500:
        raise StoreError(f"days: found {days:g}, expected more than 0 and 36500 at most")
    secret, columns = PREFIX + secrets.token_urlsafe(32), schema.users.c
    with changing(store.engine) as connection:
        row = connection.execute(select(columns.id, columns.role).where(columns.name == name)).first()
        if row is None:
            raise _no_account(name)
        own = Role.parse(row.role)
        if role is not None and role > own:
            raise StoreError(f"role: {name!r} is {row.role}, expected a token for that or less")
        now = now_us()
        token = {"user_id": row.id, "digest": digest_of(secret), "role": (role or own).name.lower(), "created_us": now}
        expires = None if days is None else now + int(days * MICROSECONDS_PER_DAY)
        connection.execute(insert(schema.tokens).values(**token, expires_us=expires))
    return secret


def set_password(store: Store, name: str, password: str) -> None:
    """Give an account a password, with which its pages are opened in a browser; whoever is logged in is no more.

    So are tokens that were made for no longer than a session lasts; others, which programs have, go on.
    """
    kept, sessions = hashed(password), schema.tokens.c
    with changing(store.engine) as connection:
        id = connection.scalar(select(schema.users.c.id).where(schema.users.c.name == name))
        if id is None:
            raise _no_account(name)
        connection.execute(update(schema.users).where(schema.users.c.id == id).values(password_hash=kept))
        short = sessions.expires_us - sessions.created_us <= int(SESSION_DAYS * MICROSECONDS_PER_DAY)
        held = (sessions.user_id == id, short, sessions.revoked_us.is_(None))
        connection.execute(update(schema.tokens).where(*held).values(revoked_us=now_us()))


def log_in(store: Store, name: str, password: str) -> str | None:
    """A token for a browser, for half a day; None where the name or the password is wrong, and nobody learns which."""
    columns = schema.users.c
    with store.engine.connect() as connection:
        kept = connection.scalar(select(columns.password_hash).where(columns.name == name))
    return issue(store, name, days=SESSION_DAYS) if is_password(password, kept) else None


def end(store: Store, secret: str) -> None:
    """End a token by itself, as when somebody logs out; nothing happens where it has ended."""
    columns = schema.tokens.c
    holds = (columns.digest == digest_of(secret), columns.revoked_us.is_(None))
    with changing(store.engine) as connection:
        connection.execute(update(schema.tokens).where(*holds).values(revoked_us=now_us()))


def revoke(store: Store, token: int, *, user: str | None = None) -> None:
    """End a token at once; `user`: only where it is theirs.

    Raises
    ------
    StoreError
        If there is none that holds.
    """
    columns = schema.tokens.c
    condition = (columns.id == token) & columns.revoked_us.is_(None)
    if user is not None:
        condition &= columns.user_id.in_(select(schema.users.c.id).where(schema.users.c.name == user))
    with changing(store.engine) as connection:
        done = connection.execute(update(schema.tokens).where(condition).values(revoked_us=now_us()))
        if not done.rowcount:
            raise StoreError(f"token {token}: there is none that holds, expected one of the list of tokens")


def account_of(store: Store, secret: str) -> Account | None:
    """Whose token it is; None where it is nobody's, has expired or was revoked."""
    with store.engine.connect() as connection:
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


def users(store: Store) -> tuple[User, ...]:
    """All accounts, by name."""
    columns, held = schema.users.c, dict[str, int]()
    for token in tokens(store):
        if token.revoked_at is None:
            held[token.user] = held.get(token.user, 0) + 1
    with store.engine.connect() as connection:
        rows = connection.execute(select(schema.users).order_by(columns.name)).all()
    return tuple(User(row.name, row.role, row.email, _moment(row.created_us), held.get(row.name, 0)) for row in rows)


def tokens(store: Store, user: str | None = None) -> tuple[Token, ...]:
    """All tokens, or those of one account, the first first; those that were revoked too."""
    columns = schema.tokens.c
    asked = select(schema.tokens, schema.users.c.name).join(schema.users, schema.users.c.id == columns.user_id)
    if user is not None:
        asked = asked.where(schema.users.c.name == user)
    with store.engine.connect() as connection:
        return tuple(_token(row) for row in connection.execute(asked.order_by(columns.id)))


def digest_of(secret: str) -> bytes:
    """What a store keeps of a token."""
    return sha256(secret.encode("utf-8", "surrogateescape")).digest()


def _token(row: Any) -> Token:
    moments = (None if us is None else _moment(us) for us in (row.expires_us, row.revoked_us))
    return Token(row.id, row.name, row.role, _moment(row.created_us), *moments)


def _moment(us: int) -> datetime:
    return EPOCH + timedelta(microseconds=us)


def _no_account(name: str) -> StoreError:
    return StoreError(f"name: {name!r} has no account, expected one of `palpate user list`")
