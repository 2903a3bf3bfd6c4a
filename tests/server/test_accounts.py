"""Accounts and tokens in the store itself."""

import pytest
from sqlalchemy import select

from palpate.server.security.accounts import Account, Role, add_user, set_role, users
from palpate.server.security.tokens import account_of, issue, revoke, tokens
from palpate.store import schema
from palpate.store.errors import StoreError
from palpate.store.store import Store


def test_a_token_says_who_and_what(store: Store) -> None:
    """A token is for the lesser of its own role and that of its account, also when that changes."""
    add_user(store, "ann", Role.CURATOR, "ann@example.org")
    secret, lesser = issue(store, "ann"), issue(store, "ann", Role.OWNER)
    assert account_of(store, secret) == Account("ann", Role.CURATOR)
    assert account_of(store, lesser) == Account("ann", Role.OWNER)
    set_role(store, "ann", Role.READER)
    assert account_of(store, secret) == Account("ann", Role.READER)
    set_role(store, "ann", Role.ADMIN)
    assert account_of(store, secret) == Account("ann", Role.CURATOR)
    assert [(one.name, one.role, one.email, one.tokens) for one in users(store)] == [
        ("ann", "admin", "ann@example.org", 2)
    ]


def test_the_store_does_not_know_the_secret(store: Store) -> None:
    """Two tokens differ, are long, and stand nowhere in the database."""
    add_user(store, "ann", Role.OWNER)
    secrets = {issue(store, "ann") for _ in range(3)}
    assert len(secrets) == 3
    assert min(map(len, secrets)) >= 40
    with store.engine.connect() as connection:
        rows = repr(connection.execute(select(schema.tokens)).all())
    assert not [secret for secret in secrets if secret in rows or secret.removeprefix("palpate_") in rows]


def test_revoked_expired_unknown(store: Store) -> None:
    """None of these is anybody's."""
    add_user(store, "ann", Role.OWNER)
    add_user(store, "bob", Role.OWNER)
    secret, expired = issue(store, "ann"), issue(store, "ann", days=1e-9)
    (number, *_) = [one.id for one in tokens(store, "ann")]
    with pytest.raises(StoreError, match="none that holds"):
        revoke(store, number, user="bob")
    assert account_of(store, secret) is not None
    revoke(store, number, user="ann")
    for wrong in (secret, expired, "", "palpate_", secret.upper(), "\udcff"):
        assert account_of(store, wrong) is None
    with pytest.raises(StoreError, match="none that holds"):
        revoke(store, number)


def test_a_token_does_what_its_account_may(store: Store) -> None:
    """Who is a reader by now ends the token of a time when they were more, which does no more than they may."""
    add_user(store, "ann", Role.CURATOR)
    issue(store, "ann")
    (held,) = tokens(store, "ann")
    with pytest.raises(StoreError, match="none that holds"):
        revoke(store, held.id, user="ann", most=Role.READER)
    set_role(store, "ann", Role.READER)
    revoke(store, held.id, user="ann", most=Role.READER)


@pytest.mark.parametrize(
    "name", ["", " ann", "ann ", "a\nb", "a\x00b", "a\u202eb", "a" * 201, "Owner of the store", "the example"]
)
def test_names_that_would_mislead(store: Store, name: str) -> None:
    """A name that looks like another one, or like none, or is too long or that of the service itself, is refused."""
    with pytest.raises(StoreError, match="name"):
        add_user(store, name, Role.OWNER)


def test_mistakes_are_told(store: Store) -> None:
    """One sentence says what would be right."""
    add_user(store, "ann", Role.OWNER)
    with pytest.raises(StoreError, match="'ann' has an account"):
        add_user(store, "ann", Role.ADMIN)
    with pytest.raises(StoreError, match="'bob' has no account"):
        issue(store, "bob")
    with pytest.raises(StoreError, match="'ann' is owner"):
        issue(store, "ann", Role.ADMIN)
    with pytest.raises(StoreError, match="days"):
        issue(store, "ann", days=0)
    with pytest.raises(StoreError, match="choose from 'reader', 'owner', 'curator', 'admin'"):
        Role.parse("nobody")
    with pytest.raises(StoreError, match="has no account"):
        set_role(store, "bob", Role.ADMIN)
