"""Logging in with a browser."""

import re
from dataclasses import replace
from html import unescape

import pytest
from fastapi.testclient import TestClient

from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.logging_in import set_password
from palpate.server.security.passwords import hashed, is_password
from palpate.server.security.rates import Rate
from palpate.server.security.tokens import tokens
from palpate.server.security.tries import Tries
from palpate.server.settings import Settings
from palpate.store.store import Store
from tests.store.made_up import squeeze

PASSWORD = "correct horse battery"
ORIGIN = {"Origin": "http://testserver"}


def log_in(client: TestClient, name: str = "ann", password: str = PASSWORD, **headers: str) -> int:
    fields = {"name": name, "password": password}
    found = client.post("/login", data=fields, headers={**ORIGIN, **headers}, follow_redirects=False)
    return found.status_code


def test_a_session_begins_and_ends(client: TestClient, store: Store) -> None:
    """Logged in one sees what is one's own; logged out no more, also with the old cookie."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    store.put(squeeze(owner="ann"))
    assert "Log in" in client.get("/").text
    assert log_in(client) == 303
    page = client.get("/recordings").text
    assert "ann" in page
    assert "private" in page
    cookie = client.cookies["palpate-session"]
    assert client.post("/logout", headers=ORIGIN, follow_redirects=False).status_code == 303
    assert "palpate-session" not in client.cookies
    client.cookies.set("palpate-session", cookie)
    assert "private" not in client.get("/recordings").text


def test_who_must_log_in_is_led_there_and_back(client: TestClient, store: Store) -> None:
    """To the page that was asked for, also after a wrong password; and to no page of another site."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    refused = client.get("/upload?device=a%26b", headers={"Accept": "text/html"})
    assert refused.status_code == 401
    (way,) = re.findall(r'<a class="button" href="(/login\?next=[^"]*)"', refused.text)
    form = client.get(way.replace("&amp;", "&")).text
    assert 'name="next" value="/upload?device=a%26b"' in form
    fields = {"name": "ann", "password": "wrong", "next": "/upload?device=a%26b"}
    assert 'name="next" value="/upload?device=a%26b"' in client.post("/login", data=fields, headers=ORIGIN).text
    for given, expected in (
        ("/upload?device=a%26b", "/upload?device=a%26b"),
        ("//evil.example/", "/"),
        ("/\\evil.example/", "/"),
        ("/\t/evil.example/", "/"),
        ("https://evil.example/", "/"),
        ("upload", "/"),
        ("/x\r\nSet-Cookie: a=b", "/"),
        ("/login", "/"),
    ):
        fields = {"name": "ann", "password": PASSWORD, "next": given}
        found = client.post("/login", data=fields, headers=ORIGIN, follow_redirects=False)
        assert (found.status_code, found.headers["location"]) == (303, expected)


def test_who_is_logged_in_by_password_is_not_told_of_tokens(client: TestClient, store: Store) -> None:
    """Nor how the server takes an address apart."""
    add_user(store, "ann", Role.READER)
    set_password(store, "ann", PASSWORD)
    assert log_in(client) == 303
    page = {"Accept": "text/html"}
    refused = client.get("/upload", headers=page)
    assert (refused.status_code, "your account is that of a reader, expected owner" in refused.text) == (403, True)
    assert "token" not in refused.text
    odd = client.get("/recordings?pages=2", headers=page)
    assert (odd.status_code, "pages: is not known here" in odd.text) == (422, True)
    assert "query." not in odd.text


def test_cookies_are_kept_from_scripts_and_other_sites(store: Store) -> None:
    """And over TLS from connections without it."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    with TestClient(application(store, Settings(secure=True, requests_per_s=None))) as client:
        found = client.post(
            "/login", data={"name": "ann", "password": PASSWORD}, headers=ORIGIN, follow_redirects=False
        )
    for word in ("HttpOnly", "SameSite=strict", "Secure", "Path=/"):
        assert word in found.headers["set-cookie"]
    assert "max-age=31536000" in found.headers["strict-transport-security"]


def test_a_session_cannot_be_given_to_somebody(client: TestClient, store: Store) -> None:
    """Whatever cookie a browser brings, logging in makes another one; a form of another site logs nobody in."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    client.cookies.set("palpate-session", "fixed")
    assert log_in(client, Origin="http://evil.example") == 403
    assert log_in(client) == 303
    first = client.cookies.get("palpate-session", domain="testserver.local")
    assert first not in (None, "fixed")
    log_in(client)
    assert client.cookies.get("palpate-session", domain="testserver.local") != first
    assert all(one.expires_at is not None for one in tokens(store, "ann"))


def test_passwords_are_not_guessed(client: TestClient, store: Store) -> None:
    """Wrong names and passwords look the same, and after some tries there are no more for a while."""
    add_user(store, "ann", Role.OWNER)
    add_user(store, "without", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    answers = set()
    for name, password in (("ann", "wrong horse battery"), ("bob", PASSWORD), ("without", ""), ("without", PASSWORD)):
        found = client.post("/login", data={"name": name, "password": password}, headers=ORIGIN)
        shown = re.sub(r'nonce="[\w-]+"', "", found.text.replace(f'value="{name}"', ""))
        answers.add((found.status_code, shown))
    assert len(answers) == 1
    assert {status for status, _ in answers} == {403}
    codes = [log_in(client, password=f"wrong horse {number}") for number in range(12)]
    assert codes[0] == 403
    assert codes[-1] == 429
    # also with the right one, or else it would be told by that
    assert log_in(client) == 429
    # who sits elsewhere is not locked out
    with TestClient(client.app, client=("192.0.2.7", 50000)) as elsewhere:
        assert log_in(elsewhere) == 303


@pytest.mark.parametrize("addresses", [["192.0.2.1"], ["2001:db8::1", "2001:db8::2"]])
def test_one_password_is_not_tried_for_many_names(store: Store, addresses: list[str]) -> None:
    """After some tries from one address, or from one network of IPv6, there are no more, whatever the name."""
    app = application(store, Settings(requests_per_s=None))
    app.state.palpate = replace(app.state.palpate, tries=Tries(of_address=Rate(per_s=0.01, burst=2)))
    codes = []
    for number in range(4):
        client = TestClient(app, client=(addresses[number % len(addresses)], 50000))
        codes.append(log_in(client, f"name {number}"))
    assert codes == [403, 403, 429, 429]


def test_the_store_does_not_know_passwords() -> None:
    """Two accounts of one password differ in what is kept, and the least change is another password."""
    first, second = hashed(PASSWORD), hashed(PASSWORD)
    assert first != second
    assert PASSWORD not in first
    assert is_password(PASSWORD, first)
    assert is_password(PASSWORD, second)
    for wrong in (PASSWORD + " ", PASSWORD.upper(), "", "x" * 10_000, "\udcff" * 10):
        assert not is_password(wrong, first)
    assert not is_password("", None)


def test_what_is_private_says_to_log_in_and_leads_back(client: TestClient, store: Store) -> None:
    """To who is not logged in; who is logged in is not told to."""
    add_user(store, "ann", Role.OWNER)
    add_user(store, "eve", Role.OWNER)
    for name in ("ann", "eve"):
        set_password(store, name, PASSWORD)
    address = f"/recordings/{store.put(squeeze(owner='ann')).id}"
    page = {"Accept": "text/html"}
    refused = client.get(address, headers=page)
    assert (refused.status_code, f'If it is private, <a href="/login?next={address}">' in refused.text) == (404, True)
    fields = {"name": "ann", "password": PASSWORD, "next": address}
    found = client.post("/login", data=fields, headers=ORIGIN, follow_redirects=False)
    assert found.headers["location"] == address
    assert client.get(address, headers=page).status_code == 200
    assert log_in(client, "eve") == 303
    assert "If it is private" not in client.get(address, headers=page).text


def test_what_was_typed_outlives_a_session(client: TestClient, store: Store) -> None:
    """It is kept by the form to log in by, also after a wrong password, and sent by whoever is logged in then."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    assert log_in(client) == 303
    set_password(store, "ann", PASSWORD)
    measured = {"dataset": "lab", "object": 'a "new" mug', "action": "weighing", "property": "mass", "value": "118"}
    measured |= {"unit": "g", "recorded_at": "2026-01-02T03:04", "sd": "", "name": "not that of an account"}
    page = {"Accept": "text/html", "Referer": "http://testserver/upload", **ORIGIN}
    ended = client.post("/upload/one", data=measured, headers=page)
    assert (ended.status_code, "What you typed is kept" in ended.text) == (401, True)
    for password, status in (("wrong horse battery", 403), (PASSWORD, 200)):
        (typed,) = re.findall(r'name="typed" value="([^"]*)"', ended.text)
        fields = {"name": "ann", "password": password, "typed": unescape(typed)}
        ended = client.post("/login", data=fields, headers=page)
        assert ended.status_code == status
    assert 'action="/upload/one"' in ended.text
    sent = {
        name: unescape(value) for name, value in re.findall(r'type="hidden" name="(\w+)" value="([^"]*)"', ended.text)
    }
    assert sent == measured
    assert client.post("/upload/one", data=sent, headers=page, follow_redirects=False).status_code == 303


def test_only_what_a_page_of_this_site_has_sent_is_kept(client: TestClient) -> None:
    """Files are not, and who sends them comes back to the page of their form; nothing leads to another site."""
    page = {"Accept": "text/html", "Referer": "http://testserver/upload?a=b"}
    files = client.post("/upload", files={"files": ("a.json", b"{}")}, headers={**page, **ORIGIN})
    assert (files.status_code, 'href="/login?next=/upload%3Fa%3Db"' in files.text) == (401, True)
    foreign = {"Accept": "text/html", "Origin": "http://evil.example", "Referer": "http://evil.example/upload"}
    other = client.post("/upload/one", data={"object": "mug"}, headers=foreign)
    assert (other.status_code, "mug" in other.text, 'href="/login"' in other.text) == (401, False, True)
    for typed in ("{", "[1, 2]", '["/upload", {}, 1]', '["//evil.example/", {}]', "[" * 100_000):
        fields = {"name": "nobody", "password": "wrong", "typed": typed}
        told = client.post("/login", data=fields, headers=ORIGIN)
        assert (told.status_code, 'name="typed"' in told.text) == (403, False)
