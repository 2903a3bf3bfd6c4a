"""Logging in by an OpenID provider: only by what it has signed for this server, this browser and now."""

import re
import time
from base64 import urlsafe_b64encode
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from html import escape, unescape
from itertools import islice
from typing import Any
from urllib.parse import urlencode

import httpx2
import pytest
from fastapi.testclient import TestClient

from palpate.errors import PalpateError
from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user, users
from palpate.server.security.asking import AT_ONCE
from palpate.server.security.identities import link
from palpate.server.security.rates import Rate
from palpate.server.security.single_sign_on import check_issuer
from palpate.server.security.tries import Tries
from palpate.server.settings import OIDC_SECRET, Settings
from palpate.store.errors import StoreError
from palpate.store.store import Store
from tests.server.provider import CLIENT, SECRET, ECKey, FakeProvider, OctKey, RSAKey, provided
from tests.store.made_up import squeeze

START, SESSION, ATTEMPT = "/login/provider", "palpate-session", "palpate-attempt"
OTHER = RSAKey.generate_key(2048, {"kid": "first"})


@pytest.fixture
def provider() -> Iterator[FakeProvider]:
    with provided() as found:
        yield found


@pytest.fixture
def settings(provider: FakeProvider, monkeypatch: pytest.MonkeyPatch) -> Settings:
    monkeypatch.setenv(OIDC_SECRET, SECRET)
    return Settings(requests_per_s=None, oidc_issuer=provider.issuer, oidc_client_id=CLIENT)


@pytest.fixture
def client(store: Store, settings: Settings) -> TestClient:
    add_user(store, "ann", Role.OWNER, "ann@lab.example")
    return TestClient(application(store, settings), follow_redirects=False)


def sign_on(client: TestClient, provider: FakeProvider) -> Any:
    """What the browser is shown in the end."""
    sent = client.get(START)
    assert sent.status_code == 303, sent.text
    return client.get(provider.log_in(sent.headers["location"]))


def is_in(client: TestClient) -> str | None:
    """Who is logged in."""
    page = client.get("/").text
    return (
        None
        if 'href="/login"' in page
        else page.partition('<form class="who"')[2].partition('<a href="/account">')[2].partition("<")[0]
    )


def test_somebody_with_an_account_logs_in(client: TestClient, store: Store, provider: FakeProvider) -> None:
    """By an address that the provider has verified; they see what is theirs, and may log out."""
    store.put(squeeze(owner="ann"))
    assert f'href="{START}"' in client.get("/login").text
    found = sign_on(client, provider)
    assert found.status_code == 200
    cookies = found.headers.get_list("set-cookie")
    (session,) = (one for one in cookies if one.startswith(f"{SESSION}="))
    assert all(word in session for word in ("HttpOnly", "SameSite=strict", "Path=/"))
    assert is_in(client) == "ann"
    assert "private" in client.get("/recordings").text
    client.post("/logout", headers={"Origin": "http://testserver"})
    assert is_in(client) is None


def test_from_then_on_they_are_known_by_who_they_are(client: TestClient, store: Store, provider: FakeProvider) -> None:
    """An address that was given to somebody else later is not the account; the same person with another one is."""
    assert sign_on(client, provider).status_code == 200
    client.cookies.clear()
    provider.claims = {"sub": "s-2", "email": "ann@lab.example", "email_verified": True}
    refused = sign_on(client, provider)
    assert refused.status_code == 403
    assert "somebody else" in refused.text
    assert is_in(client) is None
    provider.claims = {"sub": "s-1", "email": "ann@elsewhere.example", "email_verified": False}
    assert sign_on(client, provider).status_code == 200
    assert is_in(client) == "ann"


def test_an_administrator_says_who_somebody_is(client: TestClient, store: Store, provider: FakeProvider) -> None:
    """By the provider's own word for them, which holds for that provider alone."""
    provider.claims = {"sub": "b-7"}
    add_user(store, "bob", Role.CURATOR)
    link(store, "bob", issuer="https://another.example", subject="b-7")
    assert sign_on(client, provider).status_code == 403
    link(store, "bob", issuer=provider.issuer, subject="b-7")
    assert sign_on(client, provider).status_code == 200
    assert is_in(client) == "bob"
    with pytest.raises(StoreError, match="'bob' is known by that already"):
        link(store, "ann", issuer=provider.issuer, subject="b-7")
    with pytest.raises(StoreError, match="'ann' is known by that already"):
        link(store, "bob", email="ANN@lab.example")
    with pytest.raises(StoreError, match="'carla' has no account"):
        link(store, "carla", email="carla@lab.example")


ELSEWHERE = (
    "//evil.example/",
    "/\\evil.example/",
    "/\t/evil.example/",
    "/\n/evil.example/",
    "https://evil.example/",
    "javascript:alert(1)",
    "upload",
    "/x\r\nSet-Cookie: a=b",
    "/login/provider",
    "/" + "x" * 3000,
    "",
)
"""Places that nobody is led to from a log-in."""


@pytest.mark.parametrize("store", ["sqlite"], indirect=True)
def test_they_come_back_to_the_page_where_they_were(client: TestClient, provider: FakeProvider) -> None:
    """From that page by the link on top and the log-in to the provider, and on from there also where it failed."""
    page = "/recordings?text=a%26b&limit=7"
    (way,) = re.findall('class="who" href="([^"]*)"', client.get(page).text)
    (leave,) = re.findall(f'href="({START}[^"]*)"', client.get(unescape(way)).text)
    back = provider.log_in(client.get(unescape(leave)).headers["location"])
    found = client.get(back)
    assert found.status_code == 200
    assert f'content="0;url={escape(page)}"' in found.text
    assert f'<a href="{escape(page)}">Go on</a>' in found.text
    client.cookies.clear()
    provider.log_in(client.get(unescape(leave)).headers["location"])
    refused = client.get(f"{START}/back?state=another")
    assert refused.status_code == 403
    (again,) = re.findall('href="([^"]*)">Log in otherwise', refused.text)
    assert unescape(leave) in unescape(client.get(unescape(again)).text)


@pytest.mark.parametrize("store", ["sqlite"], indirect=True)
def test_nobody_is_led_elsewhere_by_a_log_in(client: TestClient, provider: FakeProvider) -> None:
    """Neither by the address that the log-in begins at, nor by a cookie that somebody else has written."""
    first_page = urlsafe_b64encode(b"/").decode().rstrip("=")
    # so many tries would have to wait
    app: Any = client.app
    app.state.palpate = replace(app.state.palpate, tries=Tries(Rate(per_s=1, burst=100), Rate(per_s=1, burst=100)))
    for next in ELSEWHERE:
        sent = client.get(f"{START}?{urlencode({'next': next})}")
        assert client.cookies[ATTEMPT].split(".")[3] == first_page
        (link,) = re.findall(f'href="({START}[^"]*)"', client.get(f"/login?{urlencode({'next': next})}").text)
        assert link == START
    assert 'content="0;url=/"' in client.get(provider.log_in(sent.headers["location"])).text
    client.get(START)
    known = client.cookies[ATTEMPT].rpartition(".")[0]
    written = {urlsafe_b64encode(text.encode()).decode(): "/login" for text in ELSEWHERE[:4]}
    for hidden, expected in {
        **written,
        "!": "/login",
        "AAA": "/login",
        "_w": "/login",
        "L2E": "/login?next=/a",
    }.items():
        client.cookies.clear()
        client.cookies.set(ATTEMPT, f"{known}.{hidden}", path=START)
        assert f'href="{expected}">Log in otherwise' in client.get(f"{START}/back?state=another").text


now = int(time.time())
HERE = pytest.mark.parametrize("store", ["sqlite"], indirect=True)
"""What asks nothing of a database that differs."""


@HERE
@pytest.mark.parametrize(
    "changes",
    [
        {"signed_by": OTHER},
        {"signed_by": RSAKey.generate_key(2048, {"kid": "unknown"})},
        {"signed_by": OctKey.import_key(SECRET * 3), "algorithm": "HS256"},
        {"signed_by": ECKey.generate_key("P-256", {"kid": "first"}), "algorithm": "ES256"},
        {"changes": {"nonce": "another"}},
        {"changes": {"nonce": None}},
        {"changes": {"aud": "another"}},
        {"changes": {"aud": [CLIENT, "another"]}},
        {"changes": {"azp": "another"}},
        {"changes": {"iss": "https://another.example"}},
        {"changes": {"exp": now - 3600}},
        {"changes": {"exp": None}},
        {"changes": {"iat": now + 36_000}},
        {"changes": {"sub": None}},
        {"changes": {"sub": ""}},
        {"changes": {"email_verified": False}},
        {"changes": {"email_verified": "true"}},
        {"changes": {"email": "mallory@lab.example"}},
        {"about": {"issuer": "https://another.example"}},
        {"about": {"jwks_uri": "http://keys.example/"}},
    ],
    # the text of a key or of a time is another in each process
    ids=[f"wrong {number}" for number in range(1, 21)],
)
def test_nobody_gets_in_by_a_wrong_answer(
    store: Store, settings: Settings, provider: FakeProvider, changes: dict[str, Any]
) -> None:
    """Signature, key, algorithm, nonce, audience, provider, times, address: each wrong one alone is a refusal."""
    add_user(store, "ann", Role.OWNER, "ann@lab.example")
    client = TestClient(application(store, settings), follow_redirects=False)
    for name, value in changes.items():
        setattr(provider, name, value)
    sent = client.get(START)
    if sent.status_code == 503:
        assert "about" in changes
        return
    refused = client.get(provider.log_in(sent.headers["location"]))
    assert refused.status_code == 403, refused.text
    assert "You are not logged in" in refused.text
    assert SESSION not in client.cookies
    assert [one.name for one in users(store)] == ["ann"]


@HERE
def test_keys_are_asked_for_again_where_one_is_new(client: TestClient, provider: FakeProvider) -> None:
    """And only then: a provider that changes its keys goes on logging people in."""
    for _ in range(2):
        assert sign_on(client, provider).status_code == 200
    assert provider.asked.count("/jwks_uri") == 1
    provider.key = RSAKey.generate_key(2048, {"kid": "second"})
    assert sign_on(client, provider).status_code == 200
    assert provider.asked.count("/jwks_uri") == 2


@HERE
def test_a_provider_that_signs_by_shared_secrets_alone_logs_nobody_in(
    client: TestClient, provider: FakeProvider
) -> None:
    """Also where its keys hold such a secret, which everybody can read there."""
    provider.about = {"id_token_signing_alg_values_supported": ["HS256"]}
    provider.key, provider.algorithm = OctKey.generate_key(256, {"kid": "first"}), "HS256"
    assert sign_on(client, provider).status_code == 403
    assert is_in(client) is None


@HERE
def test_an_answer_is_taken_once_and_by_who_asked(client: TestClient, provider: FakeProvider) -> None:
    """Not again, not from another browser, not with another state, and not from another provider."""
    back = provider.log_in(client.get(START).headers["location"])
    kept = client.cookies[ATTEMPT]
    with TestClient(client.app, follow_redirects=False) as other:
        assert other.get(back).status_code == 403
        # their own attempt does not go with somebody else's answer
        other.get(START)
        assert other.get(back).status_code == 403
        assert SESSION not in other.cookies
    assert client.get(f"{back}&iss=https%3A%2F%2Fanother.example").status_code == 403
    back = provider.log_in(client.get(START).headers["location"])
    assert client.get(back.replace("state=", "state=x")).status_code == 403
    back = provider.log_in(client.get(START).headers["location"])
    kept = client.cookies[ATTEMPT]
    assert client.get(back).status_code == 200
    assert ATTEMPT not in client.cookies
    client.cookies.clear()
    assert client.get(back).status_code == 403
    client.cookies.set(ATTEMPT, kept, path=START)
    # the provider gives nothing for a code that it had
    assert client.get(back).status_code == 403
    assert is_in(client) is None


@HERE
def test_a_provider_that_refuses_is_told(client: TestClient, provider: FakeProvider) -> None:
    """Who changes their mind there is not logged in here."""
    state = provider.log_in(client.get(START).headers["location"]).rpartition("state=")[2]
    refused = client.get(f"{START}/back?error=access_denied&error_description=%3Cscript%3E&state={state}")
    assert refused.status_code == 403
    assert "has logged nobody in" in refused.text
    assert "<script>" not in refused.text.replace("<script src=", "")


def test_unknown_people_are_readers_where_the_operator_says_so(
    store: Store, settings: Settings, provider: FakeProvider
) -> None:
    """Not unless told; and never under a name that owns something here."""
    provider.claims = {"sub": "n-1", "email": "new@lab.example", "email_verified": True}
    strict = TestClient(application(store, settings), follow_redirects=False)
    refused = sign_on(strict, provider)
    assert refused.status_code == 403
    assert "no account here" in refused.text
    open_ = TestClient(application(store, replace(settings, oidc_new_readers=True)), follow_redirects=False)
    for _ in range(2):
        assert sign_on(open_, provider).status_code == 200
        assert is_in(open_) == "new@lab.example"
    assert [(one.name, one.role) for one in users(store)] == [("new@lab.example", "reader")]
    store.put(squeeze(1, owner="robot@lab.example"))
    store.put(squeeze(2), uploader="sender@lab.example")
    for name in ("robot@lab.example", "sender@lab.example"):
        provider.claims = {"sub": name, "email": name, "email_verified": True}
        assert sign_on(open_, provider).status_code == 403
    provider.claims = {"sub": "n-2", "email": "unverified@lab.example"}
    assert sign_on(open_, provider).status_code == 200
    assert is_in(open_) == "n-2@127.0.0.1"
    assert len(users(store)) == 2


@HERE
def test_a_provider_that_does_not_answer(store: Store, settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    """Is a page that says so and when to try again, and passwords go on; for some seconds it is not asked again."""
    with provided() as gone:
        silent = replace(settings, oidc_issuer=gone.issuer)
    client = TestClient(application(store, silent), follow_redirects=False)
    asked, get = list[str](), httpx2.get

    def counted(address: str, **options: Any) -> Any:
        asked.append(address)
        return get(address, **options)

    monkeypatch.setattr(httpx2, "get", counted)
    for _ in range(3):
        found = client.get(START)
        assert found.status_code == 503
        assert 1 <= int(found.headers["Retry-After"]) <= 11
        assert "does not answer" in found.text
    assert asked == [f"{gone.issuer}/.well-known/openid-configuration"]
    assert client.get("/login").status_code == 200


@HERE
def test_a_slow_provider_holds_up_few(client: TestClient, provider: FakeProvider) -> None:
    """The others are told at once, so that most threads of the server stay with those who want something else."""
    provider.slow.clear()
    with ThreadPoolExecutor(10) as pool:
        waiting = [pool.submit(client.get, START) for _ in range(9)]
        told = [one.result() for one in islice(as_completed(waiting, timeout=20.0), 9 - AT_ONCE)]
        assert {one.status_code for one in told} == {503}
        assert {one.headers["Retry-After"] for one in told} == {"3"}
        assert client.get("/login").status_code == 200
        provider.slow.set()
        assert sorted(one.result().status_code for one in waiting) == [303] * AT_ONCE + [503] * (9 - AT_ONCE)
    assert len(provider.asked) == AT_ONCE
    assert sign_on(client, provider).status_code == 200


@HERE
def test_leaving_for_a_provider_is_counted(client: TestClient, provider: FakeProvider) -> None:
    """As tries to log in are, for each address."""
    assert [client.get(START).status_code for _ in range(11)] == [303] * 10 + [429]


@HERE
def test_without_a_provider_there_is_none(store: Store) -> None:
    client = TestClient(application(store, Settings(requests_per_s=None)))
    assert START not in client.get("/login").text
    assert client.get(START).status_code == client.get(f"{START}/back").status_code == 404


def test_settings_reach_workers_without_the_secret(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    """The secret stays in the variable that it came in."""
    import os

    monkeypatch.setenv("PALPATE_SERVER", "")
    settings.to_environment()
    assert SECRET not in os.environ["PALPATE_SERVER"]
    assert Settings.from_environment() == settings


@pytest.mark.parametrize(
    "address", ["", "login.example", "http://login.example", "ftp://a", "https://a/?b", "http://["]
)
def test_only_a_provider_with_tls_is_trusted(address: str) -> None:
    """Or one on this computer."""
    with pytest.raises(PalpateError, match="expected an address that begins with https://"):
        check_issuer(address)
    check_issuer("https://login.example/realms/lab")
    check_issuer("http://127.0.0.1:8080")
