"""Accounts: who may do what with a store over the network."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import IntEnum
from functools import cached_property

from sqlalchemy import func, insert, or_, select, update

from palpate.errors import choices
from palpate.server.security.lifetimes import is_of_session
from palpate.store import schema
from palpate.store.database import asking, changing
from palpate.store.errors import StoreError
from palpate.store.registry import now_us
from palpate.store.rows import moment_at
from palpate.store.store import Store
from palpate.store.texts import check_length, check_name
from palpate.store.viewing import Viewer

__all__ = [
    "EXAMPLE",
    "HOST_NAME",
    "Account",
    "Role",
    "User",
    "add_user",
    "has_account",
    "no_account",
    "set_role",
    "users",
]

HOST_NAME = "owner of the store"
"""Whoever started the server, on their own computer."""
EXAMPLE = "the example"
"""Whose the recordings of the example are."""


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

    @property
    def with_article(self) -> str:
        """In a sentence: "a reader", "an owner"."""
        return f"{'an' if self.name[0] in 'AO' else 'a'} {self.name.lower()}"

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

    @cached_property
    def viewer(self) -> Viewer:
        """What they see, as of the first look."""
        return Viewer(self.name, lab=self.role >= Role.READER, everything=self.role >= Role.ADMIN)


@dataclass(frozen=True)
class User:
    """An account as it stands in a list."""

    name: str
    role: str
    email: str | None
    created_at: datetime
    tokens: int


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
    check_length("name", name)
    if name.casefold() in (HOST_NAME, EXAMPLE):
        raise StoreError(f"name: found {name!r}, which the service itself has; expected another one")
    if name != name.strip() or any(not letter.isprintable() for letter in name):
        raise StoreError(f"name: found {name!r}, expected one without spaces around it, all of it printable")
    columns = schema.users.c
    with changing(store.engine) as connection:
        if connection.scalar(select(columns.id).where(columns.name == name)) is not None:
            raise StoreError(f"name: {name!r} has an account, expected another one")
        row = {"name": name, "role": role.name.lower(), "email": email, "created_us": now_us()}
        connection.execute(insert(schema.users).values(**row))


def has_account(store: Store, name: str | None) -> bool:
    """Whether there is an account of a name; who comes by the key of the store has none."""
    with asking(store.engine) as connection:
        return connection.scalar(select(schema.users.c.id).where(schema.users.c.name == name)) is not None


def set_role(store: Store, name: str, role: Role) -> None:
    """Let an account do more or less; its tokens with it.

    Raises
    ------
    StoreError
        If there is no such account.
    """
    columns = schema.users.c
    with changing(store.engine) as connection:
        done = connection.execute(update(schema.users).where(columns.name == name).values(role=role.name.lower()))
        if not done.rowcount:
            raise no_account(name)


def users(store: Store) -> tuple[User, ...]:
    """All accounts, by name, each with how many tokens of programs it has that hold."""
    columns, held = schema.users.c, schema.tokens.c
    lasts = or_(held.expires_us.is_(None), held.expires_us > now_us())
    holds = (held.user_id == columns.id, held.revoked_us.is_(None), lasts, ~is_of_session())
    count = select(func.count()).where(*holds).scalar_subquery()
    with asking(store.engine) as connection:
        rows = connection.execute(select(schema.users, count.label("held")).order_by(columns.name)).all()
    return tuple(User(row.name, row.role, row.email, moment_at(row.created_us), row.held) for row in rows)


def no_account(name: str) -> StoreError:
    """What is wrong where an account is not there."""
    return StoreError(f"name: {name!r} has no account, expected one of `palpate user list`")
