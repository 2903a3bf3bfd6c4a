"""The page of one's account, and that of all accounts."""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from html import unescape

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select

from palpate.server.app import application
from palpate.server.security.accounts import Account, Role, add_user, users
from palpate.server.security.lifetimes import MICROSECONDS_PER_DAY
from palpate.server.security.logging_in import knows_password, set_password
from palpate.server.security.tokens import MadeAlreadyError, account_of, issue, tokens
from palpate.server.settings import Settings
from palpate.store import schema
from palpate.store.registry import now_us
from palpate.store.store import Store
from tests.server.conftest import KEY

PASSWORD, OTHER = "correct horse battery", "another long password"
ORIGIN = {"Origin": "http://testserver"}


@pytest.fixture
def ann(client: TestClient, store: Store) -> TestClient:
    """Logged in, as an owner."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    return logged_in(client, "ann")


def logged_in(client: TestClient, name: str, password: str = PASSWORD) -> TestClient:
    fields = {"name": name, "password": password}
    assert client.post("/login", data=fields, headers=ORIGIN, follow_redirects=False).status_code == 303
    return client


def send(client: TestClient, address: str, **fields: str) -> tuple[int, str]:
    found = client.post(address, data=fields, headers={**ORIGIN, "Accept": "text/html"}, follow_redirects=False)
    return found.status_code, unescape(found.text)


def audit(store: Store) -> list[tuple[str, str, str]]:
    rows = select(schema.audit.c.who, schema.audit.c.detail).where(schema.audit.c.what == "account")
    with store.engine.connect() as connection:
        told = [(row.who, json.loads(row.detail)) for row in connection.execute(rows)]
    return [(who, detail["account"], detail["did"]) for who, detail in told]


def test_a_password_is_changed_by_the_old_one(ann: TestClient, store: Store) -> None:
    """Other browsers are logged out, this one and tokens of programs are not."""
    token = issue(store, "ann")
    other = TestClient(application(store))
    logged_in(other, "ann")
    for old, new, again, said in (
        ("wrong horse battery", OTHER, OTHER, "old password: is not the one"),
        (PASSWORD, OTHER, "a third long password", "the second time it is another one"),
        (PASSWORD, "x", "x", "is 1 character long"),
    ):
        status, told = send(ann, "/account", do="password", old=old, new=new, again=again)
        assert (status, said in told) == (422, True)
        assert new not in told or new == "x"
    assert knows_password(store, "ann", PASSWORD)
    assert send(ann, "/account", do="password", old=PASSWORD, new=OTHER, again=OTHER)[0] == 303
    assert knows_password(store, "ann", OTHER)
    assert "The password was changed" in ann.get("/account?saved=password").text
    assert other.get("/account").status_code == 401
    assert account_of(store, token) is not None
    assert audit(store) == [("ann", "ann", "changed the password")]


def test_old_passwords_are_not_guessed(ann: TestClient) -> None:
    """As at the log-in, after some tries there are no more for a while."""
    wrong = {"do": "password", "old": "wrong", "new": OTHER, "again": OTHER}
    assert [send(ann, "/account", **wrong)[0] for _ in range(12)][-1] == 429


def test_tokens_are_shown_once_and_told_from_sessions(ann: TestClient, store: Store) -> None:
    """One may do less and not more than its maker, is in a list without its secret, and is ended by its maker alone."""
    add_user(store, "bob", Role.OWNER)
    issue(store, "bob")
    status, told = send(ann, "/account", do="token", role="reader", days="30")
    (secret,) = re.findall(r"palpate_[\w-]{20,}", told)
    assert (status, account_of(store, secret)) == (200, Account("ann", Role.READER))
    page = ann.get("/account").text
    assert secret not in page
    (number,) = re.findall(r"Token (\d+)", page)[:1]
    assert ("This browser" in page, page.count(">End<")) == (True, 2)
    assert [one.tokens for one in users(store)] == [1, 1]
    for fields in (
        {"role": "curator", "days": "30"},
        {"role": "reader", "days": "0.1"},
        {"role": "reader", "days": "x"},
    ):
        assert send(ann, "/account", do="token", **fields)[0] == 422
    of_bob = tokens(store, "bob")[0].id
    assert send(ann, "/account", do="end", number=str(of_bob))[0] == 422
    assert send(ann, "/account", do="end", number=number)[0] == 303
    assert account_of(store, secret) is None
    assert [did for _, _, did in audit(store)] == ["made a token for a reader", f"ended token {number}"]
    foreign = ann.post("/account", data={"do": "token"}, headers={"Origin": "http://evil.example"})
    assert foreign.status_code == 403


def test_a_form_that_is_sent_again_makes_no_second_token(ann: TestClient, store: Store) -> None:
    """As by reloading the page of the new one; the page says so, tells no secret, and makes another one when asked."""
    for count in (1, 2):
        fields = {"do": "token", "role": "reader", "days": "30", "last": last_token(ann)}
        status, told = send(ann, "/account", **fields)
        assert (status, len(re.findall(r"palpate_[\w-]{20,}", told))) == (200, 1)
        again, told = send(ann, "/account", **fields)
        assert (again, "palpate_" in told.partition("<main")[2]) == (409, False)
        assert f"Token {tokens(store, 'ann')[-1].id} was made since" in told
        assert len([one for one in tokens(store, "ann") if not one.is_session]) == count
    # what ended since is no reason to make it once more, and what another account has made is none not to
    add_user(store, "bob", Role.OWNER)
    asked = last_token(ann)
    issue(store, "bob")
    assert send(ann, "/account", do="token", role="reader", days="30", last=asked)[0] == 200
    assert send(ann, "/account", do="end", number=str(tokens(store, "ann")[-1].id))[0] == 303
    assert send(ann, "/account", do="token", role="reader", days="30", last=asked)[0] == 409
    assert send(ann, "/account", do="token", role="reader", days="30", last="soon")[0] == 422


def test_one_of_two_forms_sent_at_once_makes_a_token(ann: TestClient, store: Store) -> None:
    """A button that is pressed twice: the first one decides."""
    role, last = Role.READER, int(last_token(ann))
    with ThreadPoolExecutor(4) as pool:
        made = [pool.submit(issue, store, "ann", role, last=last) for _ in range(4)]
        faults = [one.exception() for one in made]
    assert len([one for one in faults if one is None]) == 1
    assert {type(one) for one in faults if one is not None} == {MadeAlreadyError}


def last_token(client: TestClient) -> str:
    """What the form to make a token has of those that there are."""
    (found,) = re.findall(r'name="last" value="(\d+)"', client.get("/account").text)
    return str(found)


def test_a_token_of_half_a_day_is_no_session(ann: TestClient, store: Store) -> None:
    """It is among the tokens, holds where the password changes, and makes none that lasts longer."""
    (session,) = (one.id for one in tokens(store, "ann"))
    half = [issue(store, "ann", days=days) for days in (0.5, 0.4)]
    assert [one.id for one in tokens(store, "ann") if one.is_session] == [session]
    assert [one.tokens for one in users(store)] == [2]
    browser = TestClient(application(store))
    browser.cookies.set("palpate-session", half[0])
    told = send(browser, "/account", do="token", role="reader", days="365")[1]
    (secret,) = re.findall(r"palpate_[\w-]{20,}", told)
    assert left_days(store, secret) <= 0.5
    set_password(store, "ann", OTHER)
    assert [account_of(store, one) is not None for one in half] == [True] * 2
    assert ann.get("/account").status_code == 401


def test_a_program_makes_a_token_of_no_greater_scope(client: TestClient, store: Store) -> None:
    """Than the token that asks, whatever its account may do."""
    add_user(store, "ann", Role.ADMIN)
    headers = {"Authorization": f"Bearer {issue(store, 'ann', Role.OWNER)}"}
    made = client.post("/api/v1/tokens", json={}, headers=headers)
    assert (made.status_code, account_of(store, made.json()["token"])) == (201, Account("ann", Role.OWNER))
    less = client.post("/api/v1/tokens", json={"role": "reader", "days": 2}, headers=headers).json()["token"]
    assert account_of(store, less) == Account("ann", Role.READER)
    for wrong in ({"role": "admin"}, {"role": "king"}, {"days": 0}, {"days": 1e9}, {"name": "bob"}):
        assert client.post("/api/v1/tokens", json=wrong, headers=headers).status_code == 422
    listed = client.get("/api/v1/tokens", headers=headers).json()["items"]
    assert [one["is_session"] for one in listed] == [False, False, False]


def left_days(store: Store, secret: str) -> float:
    """How long a token holds from now."""
    digest = schema.tokens.c.digest == sha256(secret.encode()).digest()
    with store.engine.connect() as connection:
        ends = connection.execute(select(schema.tokens.c.expires_us).where(digest)).scalar_one()
    return float(ends - now_us()) / MICROSECONDS_PER_DAY


def test_a_token_that_a_token_makes_ends_no_later(client: TestClient, store: Store) -> None:
    """Sent as one or as if it were a session; a browser that has logged in makes one that lasts."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    short = issue(store, "ann", days=0.01)
    asked = {"json": {"days": 36_500}, "headers": {"Authorization": f"Bearer {short}"}}
    made = client.post("/api/v1/tokens", **asked).json()["token"]  # type: ignore[arg-type]
    assert 0 < left_days(store, made) <= 0.01
    lasting = issue(store, "ann", days=None)
    of_lasting = client.post("/api/v1/tokens", json={"days": 2}, headers={"Authorization": f"Bearer {lasting}"})
    assert 1.9 < left_days(store, of_lasting.json()["token"]) <= 2
    client.cookies.set("palpate-session", short)
    told = send(client, "/account", do="token", role="reader", days="365")[1]
    (secret,) = re.findall(r"palpate_[\w-]{20,}", told)
    assert left_days(store, secret) <= 0.01
    client.cookies.clear()
    told = send(logged_in(client, "ann"), "/account", do="token", role="reader", days="365")[1]
    (secret,) = re.findall(r"palpate_[\w-]{20,}", told)
    assert 364 < left_days(store, secret) <= 365


def test_who_came_by_the_key_has_no_account(client: TestClient) -> None:
    """The page offers none of the forms that need one, and leads to where accounts are made."""
    client.cookies.set("palpate-key", KEY)
    page = client.get("/account").text
    assert "<form" not in page.partition("<main")[2]
    assert "have no account here" in page
    assert '<a href="/users">' in page
    assert send(client, "/account", do="token", role="owner", days="30")[0] == 422


def test_administrators_have_all_accounts(ann: TestClient, store: Store) -> None:
    """They add, set roles, show passwords and end tokens; nobody else does, and not their own role."""
    assert ann.get("/users").status_code == 403
    add_user(store, "root", Role.ADMIN)
    set_password(store, "root", PASSWORD)
    root = TestClient(application(store))
    logged_in(root, "root")
    status, told = send(root, "/users", do="add", name="bob", role="reader", email="")
    (password,) = re.findall(r"<code>([\w-]+)</code>", told)
    assert (status, knows_password(store, "bob", password)) == (200, True)
    assert password not in root.get("/users").text
    assert send(root, "/users", do="add", name="bob", role="reader")[0] == 422
    for email in ("notmail", "two words@lab.example", "@lab.example", "carl@"):
        status, told = send(root, "/users", do="add", name="carl", role="reader", email=email)
        assert (status, "expected an address such as ann@lab.example" in told) == (422, True)
    assert send(root, "/users", do="role", name="bob", role="curator")[0] == 303
    assert send(root, "/users", do="role", name="root", role="reader")[0] == 422
    assert {one.name: one.role for one in users(store)} == {"ann": "owner", "bob": "curator", "root": "admin"}
    assert send(root, "/users", do="password", name="nobody")[0] == 422
    assert send(root, "/users", do="password", name="ann")[0] == 200
    assert ann.get("/account").status_code == 401
    secret = issue(store, "bob")
    assert send(root, "/users", do="end", number=str(tokens(store, "bob")[-1].id))[0] == 303
    assert account_of(store, secret) is None
    assert ("root", "bob", "made it a curator") in audit(store)
    assert not [line for line in audit(store) if password in str(line)]


def test_the_log_in_says_whom_to_ask(store: Store) -> None:
    """In the words of the server, or else by the command."""
    with TestClient(application(store)) as client:
        assert "palpate user password NAME" in client.get("/login").text
    with TestClient(application(store, Settings(contact="Eve, <eve@example.org>"))) as client:
        page = client.get("/login").text
        assert ("Eve, &lt;eve@example.org&gt;" in page, "palpate user" in page) == (True, False)
