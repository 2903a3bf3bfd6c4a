"""What others upload does nothing in a browser, and what they ask does nothing to the server."""

import asyncio
import json
import logging
import time
from base64 import urlsafe_b64encode
from urllib.parse import quote

import pytest
from fastapi.testclient import TestClient
from starlette.types import Message, Receive, Scope, Send

from palpate.server.app import application
from palpate.server.problems import ProblemError
from palpate.server.security.bodies import BodyLimits
from palpate.server.settings import Settings
from palpate.server.watching import start_log
from palpate.store.records import FileItem, ThingRef
from palpate.store.store import Store
from tests.server.conftest import KEY
from tests.store.made_up import squeeze

API = "/api/v1"
EVIL = "<script>alert(1)</script>\"'><img src=x onerror=alert(2)>"
SVG = b'<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>'
HTML = b"<!doctype html><script>alert(1)</script>"
POLYGLOT = b"GIF89a/*" + HTML + b"*/=1"


@pytest.mark.parametrize(
    ("stated", "data", "expected"),
    [
        ("text/html", HTML, "application/octet-stream"),
        ("image/svg+xml", SVG, "application/octet-stream"),
        ("image/png", HTML, "application/octet-stream"),
        ("IMAGE/PNG", SVG, "application/octet-stream"),
        ("application/javascript", b"alert(1)", "application/octet-stream"),
        ("image/gif", POLYGLOT, "image/gif"),
        ("image/png\r\nX-Evil: 1", HTML, "application/octet-stream"),
        ("application/pdf", b"%PDF-1.7", "application/octet-stream"),
    ],
)
def test_files_come_back_harmless(client: TestClient, store: Store, stated: str, data: bytes, expected: str) -> None:
    """The type is a safe one and meant, nothing may run, and what is no picture or sound is a download."""
    name = f'{EVIL}\r\nX-Evil: 1/../../"evil.html'
    recording = squeeze(visibility="public", files=(FileItem(name, stated, data),))
    store.put(recording)
    found = client.get(f"{API}/recordings/{recording.id}/files/0")
    assert found.content == data
    assert found.headers["content-type"] == expected
    assert found.headers["x-content-type-options"] == "nosniff"
    assert found.headers["content-security-policy"] == "default-src 'none'; sandbox"
    shown = "inline" if expected.startswith("image/") else "attachment"
    assert found.headers["content-disposition"].startswith(f"{shown}; filename*=UTF-8''")
    assert "x-evil" not in found.headers


def test_names_are_text_on_every_page(client: TestClient, store: Store) -> None:
    """Whatever is in names, results, logs and attributes, pages show it and run nothing of it."""
    thing = ThingRef(EVIL, EVIL, EVIL, EVIL, {EVIL: EVIL}, (EVIL,))
    recording = squeeze(visibility="public", owner=EVIL, action=EVIL, thing=thing, log=EVIL, notices=(EVIL,))
    store.put(recording)
    address = client.get(f"{API}/objects").json()["items"][0]["url"].removeprefix(API)
    for page in (
        "/",
        "/objects",
        "/recordings",
        address,
        f"/recordings/{recording.id}",
        f"/objects?text={quote(EVIL)}",
    ):
        found = client.get(page, headers={"Accept": "text/html"})
        assert found.status_code == 200, page
        assert "<script>alert" not in found.text
        assert "<img src=x" not in found.text
        assert "&lt;script&gt;" in found.text
        assert "script-src 'self'" in found.headers["content-security-policy"]


PATHS = [
    "/static/../app.py",
    "/static/..%2fapp.py",
    "/static/%2e%2e/%2e%2e/app.py",
    "/static//etc/passwd",
    f"{API}/objects/..%2f..%2fetc/passwd",
    f"{API}/objects/~2e~2e/%00",
    f"{API}/recordings/..%2f..%2fetc%2fpasswd",
    "/guides/..%2fbase",
    "/guides/%2e%2e%2fbase.html",
]


def test_no_path_leads_out(client: TestClient) -> None:
    """Nothing but what is meant to be read can be read."""
    for path in PATHS:
        assert client.get(path).status_code == 404, path


ODD = [
    "limit=0",
    "limit=501",
    f"limit={'9' * 5000}",
    "limit=1e999",
    "cursor=" + "x" * 501,
    "cursor=%00",
    "cursor=WyJyZWNvcmRlZCIsIHRydWUsIDE2LCBbXV0",
    "cursor=WyJyZWNvcmRlZCIsIHRydWUsIDk5OTk5OTk5OTk5OTk5OTk5OTk5OTk5OTk5OTk5LCAxXQ",
    "cursor=" + "W" * 400,
    "sort=digest",
    "sort=recorded;drop table recordings",
    "since=yesterday",
    "since=99999999999999999999",
    "since=2027",
    "until=2026",
    "setup=zz",
    "label=material",
    "known=:wood",
    "text=%00",
    "colour=red",
    "ground_truth=perhaps",
]


HALF, ZERO, LARGE = "\ud800", "a\0b", 1 << 63
ODD_PLACES = [
    ("recordings?sort=action", ["action", True, HALF, 1]),
    ("recordings?sort=action", ["action", True, ZERO, 1]),
    ("recordings?sort=action", ["action", True, "squeezing", LARGE]),
    ("recordings?sort=recorded", ["recorded", True, -LARGE - 1, 1]),
    ("recordings?sort=recorded", ["recorded", True, None, 1]),
    ("entries?sort=action", ["action", True, HALF, 1]),
    ("entries?sort=action", ["action", True, ZERO, 1]),
    ("objects?limit=9", [HALF, "cup"]),
    ("objects?limit=9", ["lab", ZERO]),
    ("episodes?limit=9", ["recorded", True, 1, LARGE]),
]


@pytest.mark.parametrize(("address", "place"), ODD_PLACES)
def test_cursors_that_no_database_can_look_for(
    client: TestClient, store: Store, address: str, place: list[object]
) -> None:
    """Half a letter, a zero byte or a number beyond 64 bits in a cursor is an error of who asks."""
    store.put(squeeze(visibility="public"))
    cursor = urlsafe_b64encode(json.dumps(place).encode()).decode().rstrip("=")
    found = client.get(f"{API}/{address}&cursor={cursor}")
    assert (found.status_code, found.json()["errors"][0]["field"]) == (422, "query.cursor"), found.text


def test_a_page_that_ends_at_a_long_name_has_a_next_one(client: TestClient, store: Store) -> None:
    """Letters of other scripts take up to twelve each in a cursor, which is taken as it was given."""
    names = [one * 200 for one in "日本語"]
    store.put_many([squeeze(n, thing=ThingRef(name, name), visibility="public") for n, name in enumerate(names)])
    found, address = [], f"{API}/objects?limit=1"
    while address:
        page = client.get(address).json()
        found += [one["name"] for one in page["items"]]
        address = f"{API}/objects?limit=1&cursor={page['next']}" if page["next"] else ""
    assert sorted(found) == sorted(names)


@pytest.mark.parametrize("asked", ["known=%00:a", "known=material:w%00d", "known=%ED%A0%80:a", "text=%ED%A0%80"])
@pytest.mark.parametrize("resource", ["recordings", "objects"])
def test_texts_that_no_database_can_look_for(client: TestClient, resource: str, asked: str) -> None:
    """A zero byte is refused by the name of the parameter; bytes that are no text are looked for as what they show."""
    for address in (f"{API}/{resource}", f"/{resource}"):
        found = client.get(f"{address}?{asked}")
        expected = 422 if "%00" in asked else 200
        assert found.status_code == expected, (address, found.text)
        assert expected == 200 or asked.partition("=")[0] in found.text


@pytest.mark.parametrize("resource", ["recordings", "entries"])
def test_odd_questions_are_refused_by_field(client: TestClient, store: Store, resource: str) -> None:
    """What is no question is an error of the asker, in the one form, that names the field."""
    store.put(squeeze(visibility="public"))
    for query in ODD:
        found = client.get(f"{API}/{resource}?{query}")
        assert found.status_code == 422, (query, found.text)
        assert found.headers["content-type"] == "application/problem+json"
        plain = found.json()
        assert {"type", "title", "status", "detail"} <= plain.keys()
        assert plain["status"] == 422


@pytest.mark.parametrize("resource", ["recordings", "entries", "episodes"])
def test_a_bare_year_is_not_taken_for_seconds(client: TestClient, store: Store, resource: str) -> None:
    """It is refused with what would be right, which is taken."""
    for name in ("since", "until"):
        found = client.get(f"{API}/{resource}?{name}=2027")
        assert found.status_code == 422
        detail = found.json()["detail"]
        assert detail.startswith(f"query.{name}:")
        assert "is a number, expected a date such as 2024-05-01" in detail
        assert client.get(f"{API}/{resource}?{name}=2027-01-01").status_code == 200


def test_sql_in_a_question_is_text(client: TestClient, store: Store) -> None:
    """It finds nothing, and nothing happens."""
    store.put(squeeze(visibility="public"))
    for text in ("' OR 1=1 --", "%", "_", "\\", "'; DROP TABLE recordings; --"):
        for name in ("text", "object", "action", "owner", "dataset"):
            answer = client.get(f"{API}/recordings", params={name: text})
            assert (answer.status_code, answer.json()["items"]) == (
                200,
                [] if text != "_" or name != "text" else answer.json()["items"],
            )
    assert client.get(f"{API}/recordings").json()["items"]


def test_ids_that_are_none(client: TestClient) -> None:
    """Whatever stands in the place of an id, it is not there."""
    for key in ("1", "0" * 32, "not-a-uuid", "00000000-0000-0000-0000-000000000000", "%00", "a" * 5000, "z" * 64):
        for address in (f"{API}/recordings/{key}", f"/recordings/{key}"):
            assert client.get(address).status_code == 404, key


def test_a_name_of_somebody_else_is_not_answered(store: Store) -> None:
    """A page elsewhere that points its own name here gets nothing, and a form of it does nothing."""
    settings = Settings(hosts=("127.0.0.1", "localhost", "[::1]"), key=KEY, requests_per_s=None)
    with TestClient(application(store, settings), base_url="http://127.0.0.1:8000") as client:
        assert client.get("/").status_code == 200
        assert client.get("/", headers={"Host": "[::1]:8000"}).status_code == 200
        for host in ("evil.example", "127.0.0.1.evil.example", "", "localhost@evil.example"):
            assert client.get("/", headers={"Host": host}).status_code == 421


def test_forms_of_other_sites_do_nothing(client: TestClient, store: Store) -> None:
    """The one form that changes something wants the key, and to stand on a page of this site."""
    cookie = {"Cookie": f'palpate-key="{KEY}"'}
    for origin in ({}, {"Origin": "http://evil.example"}, {"Origin": "null"}):
        assert client.post("/example", headers={**cookie, **origin}).status_code == 403
    assert client.post("/example", headers={"Origin": "http://testserver"}).status_code == 403
    assert client.get("/example").status_code == 405
    assert client.get(f"{API}/recordings", headers=cookie).json()["items"] == []


def test_only_the_right_key_opens(client: TestClient) -> None:
    """The key that was printed makes a cookie that scripts cannot read; another one does not."""
    for wrong in ("", "x", "é", KEY + "x"):
        assert client.get("/enter", params={"key": wrong}).status_code == 403
    opened = client.get("/enter", params={"key": KEY}, follow_redirects=False)
    assert (opened.status_code, opened.headers["location"]) == (303, "/")
    cookie = opened.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=strict" in cookie
    client.cookies.clear()
    assert client.get(f"{API}/users", headers={"Cookie": "palpate-key=x"}).status_code == 401


def test_without_a_key_nobody_enters(store: Store) -> None:
    """A server for many has no key."""
    with TestClient(application(store, Settings(requests_per_s=None))) as client:
        assert client.get("/enter", params={"key": ""}).status_code == 403
        assert client.get(f"{API}/users", headers={"Cookie": "palpate-key="}).status_code == 401


@pytest.mark.parametrize(
    "address", ["/", f"{API}/recordings", "/nothing", f"{API}/tokens", "/health", "/static/style.css"]
)
def test_headers_are_on_every_answer(client: TestClient, address: str) -> None:
    """Also on errors: nothing runs but this site's own scripts, and nothing is framed, sniffed or shared."""
    headers = client.get(address).headers
    policy = headers["content-security-policy"]
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "same-origin"


def test_an_unforeseen_error_tells_nothing(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """What went wrong is in the log and not in the answer, which has the form and the headers of all others."""

    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("the password is 1234")

    monkeypatch.setattr("palpate.server.api.recordings.list_recordings", broken)
    found = client.get(f"{API}/recordings")
    assert (found.status_code, found.headers["content-type"]) == (500, "application/problem+json")
    assert "1234" not in found.text
    assert "1234" in caplog.text
    assert "content-security-policy" in found.headers


def test_nobody_writes_lines_into_the_log(
    client: TestClient,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What an address says is one word of a line, and no command to a terminal; nor is what an error says."""

    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("wrong: \x1b[2J\x9b31m")

    monkeypatch.setattr("palpate.server.pages.objects.visible_thing", broken, raising=False)
    monkeypatch.setattr("palpate.server.api.parameters.visible_thing", broken)
    assert client.get(f"{API}/objects/a/b%0a%1b%5b31mfalse%20alarm").status_code == 500
    (record,) = [one for one in caplog.records if one.name == "palpate.server"]
    assert record.getMessage().isprintable()
    assert "b%0A%1B%5B31mfalse%20alarm" in record.getMessage()
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    start_log(requests=False)
    logging.getLogger().handle(record)
    told = capsys.readouterr().err
    assert "\\x1b[2J\\x9b31m" in told
    assert all(line.isprintable() for line in told.splitlines())


def test_addresses_that_ask_too_often_wait(store: Store) -> None:
    """After a burst there is an error that says when to come back; other addresses go on."""
    with TestClient(application(store, Settings(requests_per_s=0.1))) as client:
        codes = [client.get("/health").status_code for _ in range(4)]
        assert codes == [200, 200, 429, 429]
        late = client.get("/health")
        assert 0 < int(late.headers["retry-after"]) <= 11
    with TestClient(application(store, Settings(requests_per_s=0.1)), client=("10.0.0.9", 1)) as other:
        assert other.get("/health").status_code == 200


def test_a_client_that_sends_slowly_is_let_go() -> None:
    """A body that trickles ends the request, however often a byte comes."""

    async def endless() -> Message:
        await asyncio.sleep(0.01)
        return {"type": "http.request", "body": b"x", "more_body": True}

    async def reads_all(scope: Scope, receive: Receive, send: Send) -> None:
        while (await receive()).get("more_body"):
            pass

    async def send(_: Message) -> None:
        raise AssertionError("nothing is answered here")

    limited = BodyLimits(reads_all, largest=lambda *_: 1000, grace_s=0.2)
    scope = {"type": "http", "method": "PUT", "path": "/", "headers": []}
    began = time.monotonic()
    with pytest.raises(ProblemError) as refused:
        asyncio.run(limited(scope, endless, send))
    assert refused.value.status_code == 408
    assert time.monotonic() - began < 5
