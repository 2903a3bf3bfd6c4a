"""Whose account somebody has who logs in elsewhere: by letters that are the same, and also where two come at once."""

import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

import pytest

from palpate.server.security import identities
from palpate.server.security.accounts import Role, add_user, users
from palpate.server.security.identities import UnknownPersonError, account_name, link
from palpate.server.security.single_sign_on import Identity
from palpate.store.errors import StoreError
from palpate.store.store import Store

ISSUER = "https://login.lab.example"
AT_ONCE = 4


def identity(subject: str, email: str | None) -> Identity:
    return Identity(ISSUER, subject, email)


@pytest.fixture
def together(monkeypatch: pytest.MonkeyPatch) -> None:
    """All have looked for their account before one of them gets it; in SQLite those who write look one by one."""
    waiting, looked = threading.Barrier(AT_ONCE), identities._of_email

    def of_email(*asked: Any) -> list[Any]:
        found = looked(*asked)
        with suppress(threading.BrokenBarrierError):
            waiting.wait(0.5)
        return found

    monkeypatch.setattr(identities, "_of_email", of_email)


@pytest.mark.parametrize(
    "email", ["\u212aim@lab.example", "k\u0131m@lab.example", "KI\u0307M@lab.example", "kim@\u017fab.example"]
)
def test_letters_that_only_look_alike_are_others(store: Store, email: str) -> None:
    """The sign of Kelvin is no k, whatever folding says: nobody gets an account by an address that is not its own."""
    add_user(store, "kim", Role.ADMIN, "kim@lab.example")
    with pytest.raises(UnknownPersonError, match="no account here"):
        account_name(store, identity("s-1", email), new_readers=False)
    add_user(store, "other", Role.READER)
    link(store, "other", email=email)
    assert account_name(store, identity("s-1", email), new_readers=False) == "other"
    assert account_name(store, identity("s-2", "KIM@Lab.Example"), new_readers=False) == "kim"


def test_letters_beyond_ascii_are_what_they_are(store: Store) -> None:
    """Both databases tell capitals from others there, and go on finding who has such an address."""
    add_user(store, "agnes", Role.OWNER, "\u00c1gnes@lab.example")
    with pytest.raises(StoreError, match="'agnes' is known by that already"):
        link(store, "bob", email="\u00c1GNES@LAB.example")
    with pytest.raises(UnknownPersonError):
        account_name(store, identity("s-1", "\u00e1gnes@lab.example"), new_readers=False)
    assert account_name(store, identity("s-1", "\u00c1gnes@lab.example"), new_readers=False) == "agnes"


@pytest.mark.usefixtures("together")
def test_somebody_new_who_comes_several_times_at_once_has_one_account(store: Store) -> None:
    """As with a page that a browser loads again: each time they are logged in."""
    new = identity("n-1", "new@lab.example")
    with ThreadPoolExecutor(AT_ONCE) as pool:
        found = list(pool.map(lambda _: account_name(store, new, new_readers=True), range(AT_ONCE)))
    assert found == ["new@lab.example"] * AT_ONCE
    assert [one.name for one in users(store)] == ["new@lab.example"]


@pytest.mark.usefixtures("together")
def test_of_several_who_come_by_one_address_at_once_one_gets_its_account(store: Store) -> None:
    """The others are somebody else at the provider, and are told so."""
    add_user(store, "ann", Role.OWNER, "ann@lab.example")

    def come(number: int) -> str | None:
        try:
            return account_name(store, identity(f"s-{number}", "ann@lab.example"), new_readers=True)
        except UnknownPersonError:
            return None

    with ThreadPoolExecutor(AT_ONCE) as pool:
        found = list(pool.map(come, range(AT_ONCE)))
    assert sorted(map(str, found)) == ["None"] * (AT_ONCE - 1) + ["ann"]
    (first,) = (number for number, name in enumerate(found) if name == "ann")
    assert account_name(store, identity(f"s-{first}", None), new_readers=False) == "ann"
