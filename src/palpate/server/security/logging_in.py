"""Passwords, by which people log in with a browser; what they get is a token for half a day."""

from __future__ import annotations

from sqlalchemy import select, update

from palpate.server.security.accounts import no_account
from palpate.server.security.lifetimes import is_of_session
from palpate.server.security.passwords import hashed, is_password
from palpate.server.security.tokens import issue_session
from palpate.store import schema
from palpate.store.database import asking, changing
from palpate.store.registry import now_us
from palpate.store.store import Store

__all__ = ["knows_password", "log_in", "set_password"]


def set_password(store: Store, name: str, password: str) -> None:
    """Give an account a password, with which its pages are opened in a browser; whoever is logged in is no more.

    So are tokens that were made for no longer than a session lasts; others, which programs have, go on.

    Raises
    ------
    StoreError
        If there is no such account.
    """
    kept, sessions = hashed(password), schema.tokens.c
    with changing(store.engine) as connection:
        id = connection.scalar(select(schema.users.c.id).where(schema.users.c.name == name))
        if id is None:
            raise no_account(name)
        connection.execute(update(schema.users).where(schema.users.c.id == id).values(password_hash=kept))
        held = (sessions.user_id == id, is_of_session(), sessions.revoked_us.is_(None))
        connection.execute(update(schema.tokens).where(*held).values(revoked_us=now_us()))


def log_in(store: Store, name: str, password: str) -> str | None:
    """A token for a browser, for half a day; None where the name or the password is wrong, and nobody learns which."""
    return issue_session(store, name) if knows_password(store, name, password) else None


def knows_password(store: Store, name: str, password: str) -> bool:
    """Whether it is the password of an account; it takes as long where there is none."""
    columns = schema.users.c
    with asking(store.engine) as connection:
        kept = connection.scalar(select(columns.password_hash).where(columns.name == name))
    return is_password(password, kept)
