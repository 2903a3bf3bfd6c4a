"""How often somebody may ask: an address, and an account by its tokens, which are never guessed by asking often."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient

from palpate.server.app import application
from palpate.server.security import tokens
from palpate.server.security.accounts import Role
from palpate.server.security.rates import HELD_S, MOST_TOKENS, Held
from palpate.server.settings import Settings
from palpate.store.store import Store

ASKED = "/api/v1/recordings"
ONE_KIND = pytest.mark.parametrize("store", ["sqlite"], indirect=True)
Headers = dict[str, str]
Token = Callable[..., Headers]


@pytest.fixture
def slow(store: Store) -> Iterator[TestClient]:
    """Two requests of an address at once, and twenty of an account."""
    with TestClient(application(store, Settings(requests_per_s=0.1))) as found:
        yield found


def codes(client: TestClient, times: int, headers: Headers | None = None) -> list[int]:
    return [client.get(ASKED, headers=headers).status_code for _ in range(times)]


@ONE_KIND
def test_who_sends_a_token_may_ask_more_often(slow: TestClient, token: Token) -> None:
    """The first request is the address's, and the others the account's, which also ends."""
    mine = token("ann")
    assert codes(slow, 1, mine) == [200]
    assert codes(slow, 3) == [200, 429, 429]
    assert codes(slow, 25, mine) == [*[200] * 20, *[429] * 5]
    refused = slow.get(ASKED, headers=mine)
    assert refused.json()["detail"] == "too many requests from this account"
    assert 0 < int(refused.headers["retry-after"]) <= 2


@ONE_KIND
def test_tokens_of_an_account_share_its_rate(store: Store, slow: TestClient, token: Token) -> None:
    """Making more of them lets nobody ask more often; another account has a rate of its own."""
    mine, others = token("ann"), token("bob", Role.READER)
    second = {"Authorization": f"Bearer {tokens.issue(store, 'ann')}"}
    assert [codes(slow, 1, one) for one in (mine, second)] == [[200], [200]]
    assert codes(slow, 12, mine) == [200] * 12
    assert codes(slow, 12, second) == [*[200] * 8, *[429] * 4]
    assert codes(slow, 1, others) == [429], "not known yet, and the address has asked for too much"


INVENTED = {
    "unknown": "Bearer palpate_invented",
    "long": f"Bearer palpate_{'x' * 10_000}",
    "none": "Bearer ",
    "basic": "Basic YW5uOnBhbHBhdGVfeA==",
}


@ONE_KIND
@pytest.mark.parametrize("header", INVENTED.values(), ids=INVENTED.keys())
def test_what_is_no_token_is_an_address_that_asks(
    slow: TestClient, monkeypatch: pytest.MonkeyPatch, header: str
) -> None:
    """It is counted before it is looked up, each time."""
    looked: list[str] = []
    before = tokens.account_of

    def looking(store: Store, secret: str) -> Any:
        looked.append(secret)
        return before(store, secret)

    monkeypatch.setattr("palpate.server.security.who.account_of", looking)
    assert codes(slow, 6, {"Authorization": header}) == [401, 401, 429, 429, 429, 429]
    assert len(looked) <= 2


@ONE_KIND
def test_a_token_that_was_revoked_lets_nobody_in(store: Store, slow: TestClient, token: Token) -> None:
    """That it was right a moment ago is only for counting."""
    mine = token("ann")
    assert codes(slow, 2, mine) == [200, 200]
    tokens.end(store, mine["Authorization"].removeprefix("Bearer "))
    assert codes(slow, 2, mine) == [401, 401]


def test_tokens_are_forgotten() -> None:
    """After a while, and where there are very many; what is kept is no token."""
    now_s = 0.0
    held = Held(lambda: now_s)
    held.keep("palpate_a", "ann")
    assert held.account_of("palpate_a") == "ann"
    assert "palpate_a" not in repr(vars(held))
    now_s = HELD_S
    assert held.account_of("palpate_a") is None
    for number in range(MOST_TOKENS + 1):
        held.keep(f"palpate_{number}", "bob")
    assert [held.account_of(f"palpate_{number}") for number in (0, 1, MOST_TOKENS)] == [None, "bob", "bob"]
