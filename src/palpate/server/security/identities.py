"""Which account somebody has who logs in elsewhere."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import urlsplit

from sqlalchemy import Connection, collate, func, insert, select, update

from palpate.server.security.accounts import Role
from palpate.server.security.single_sign_on import Identity
from palpate.store import schema
from palpate.store.database import ACCOUNT_LOCK, asking, changing, one_at_a_time
from palpate.store.errors import StoreError
from palpate.store.registry import now_us
from palpate.store.store import Store

__all__ = ["UnknownPersonError", "account_name", "check_link", "link"]

USERS = schema.users.c
EMAIL = re.compile(r"[^@\s]+@[^@\s]+")


class UnknownPersonError(StoreError):
    """Somebody has no account here."""


def link(
    store: Store, name: str, *, email: str | None = None, issuer: str | None = None, subject: str | None = None
) -> None:
    """Say by what an account is known to a provider: an e-mail address, or who it is there.

    Raises
    ------
    StoreError
        If there is no such account, or another one is known by that.
    """
    values = {"email": email, "oidc_issuer": issuer, "oidc_subject": subject}
    given = {column: value for column, value in values.items() if value is not None}
    with changing(store.engine) as connection:
        one_at_a_time(connection, ACCOUNT_LOCK)
        _check(connection, name, email, issuer, subject)
        done = connection.execute(update(schema.users).where(USERS.name == name).values(**given)) if given else None
        if done is not None and not done.rowcount:
            raise StoreError(f"name: {name!r} has no account, expected one of `palpate user list`")


def check_link(store: Store, name: str, *, email: str | None, issuer: str | None, subject: str | None) -> None:
    """Refuse what `link` would refuse of an account that is not there yet."""
    with asking(store.engine) as connection:
        _check(connection, name, email, issuer, subject)


def _check(connection: Connection, name: str, email: str | None, issuer: str | None, subject: str | None) -> None:
    if (issuer is None) != (subject is None):
        raise StoreError("subject: expected it together with the address of the provider that it is one of")
    taken = [] if subject is None else _of_subject(connection, issuer, subject)
    if email is not None:
        if not EMAIL.fullmatch(email):
            raise StoreError(f"email: found {email[:80]!r}, expected an address such as ann@lab.example")
        taken += _of_email(connection, email)
    others = {row.name for row in taken} - {name}
    if others:
        raise StoreError(f"name: {min(others)!r} is known by that already, expected something of {name!r} alone")


def account_name(store: Store, who: Identity, *, new_readers: bool) -> str:
    """The account of somebody who has logged in elsewhere.

    Who they are there decides; the first time an address that the provider has verified, and from then on they are
    known: the address may be somebody else's later.

    Parameters
    ----------
    new_readers
        Whether who has none gets one, as a reader.

    Raises
    ------
    UnknownPersonError
        If they have none.
    """
    with changing(store.engine) as connection:
        # a browser that loads the page again comes twice, and the second must find what became of the first
        one_at_a_time(connection, ACCOUNT_LOCK)
        found = _of_subject(connection, who.issuer, who.subject)
        if found:
            return str(found[0].name)
        known = _of_email(connection, who.verified_email) if who.verified_email else []
        if known:
            return _bound(connection, known, who)
        if not new_readers:
            raise UnknownPersonError("you have no account here; whoever runs this server makes one")
        return _made(connection, who)


def _bound(connection: Connection, known: list[Any], who: Identity) -> str:
    """The account of an address, which is known by who they are from now on."""
    if len(known) > 1:
        raise UnknownPersonError(
            "several accounts have your e-mail address; whoever runs this server can tell them apart"
        )
    (row,) = known
    if row.oidc_subject is not None:
        raise UnknownPersonError("the account of your e-mail address is that of somebody else at the provider")
    values = {"oidc_issuer": who.issuer, "oidc_subject": who.subject}
    connection.execute(update(schema.users).where(USERS.id == row.id).values(**values))
    return str(row.name)


def _made(connection: Connection, who: Identity) -> str:
    name = who.verified_email or f"{who.subject}@{urlsplit(who.issuer).hostname}"
    if not name.isprintable() or name != name.strip() or len(name) > 200:
        raise UnknownPersonError("what the provider calls you cannot be the name of an account")
    if _is_taken(connection, name):
        # whoever has that name sees what is owned under it
        raise UnknownPersonError(f"{name} is the name of somebody here; whoever runs this server makes you an account")
    row = {"name": name, "role": Role.READER.name.lower(), "email": who.verified_email, "created_us": now_us()}
    identity = {"oidc_issuer": who.issuer, "oidc_subject": who.subject}
    connection.execute(insert(schema.users).values(**row, **identity))
    return name


def _is_taken(connection: Connection, name: str) -> bool:
    columns = [USERS.name]
    columns += [
        table.c[column] for table in (schema.recordings, schema.episodes) for column in ("owner", "uploaded_by")
    ]
    columns.append(schema.senders.c.name)
    return any(
        connection.execute(select(column).where(column == name).limit(1)).first() is not None for column in columns
    )


def _of_subject(connection: Connection, issuer: str | None, subject: str) -> list[Any]:
    asked = select(USERS.name).where(USERS.oidc_issuer == issuer, USERS.oidc_subject == subject)
    return list(connection.execute(asked))


def _of_email(connection: Connection, email: str) -> list[Any]:
    """Accounts of an address; only ASCII's own capitals are the same letters.

    Further folding makes a k of the sign of Kelvin, and the address of somebody else of one that is not theirs.
    """
    # SQLite knows no other letters
    column = collate(USERS.email, "C") if connection.dialect.name == "postgresql" else USERS.email
    asked = select(USERS.id, USERS.name, USERS.oidc_subject).where(func.lower(column) == _folded(email))
    return list(connection.execute(asked))


def _folded(text: str) -> str:
    return "".join(letter.lower() if letter.isascii() else letter for letter in text)
