"""Who may see what is there already, set later: by those who may, noted, and reversible; by pages as by the service."""

import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from fastapi.testclient import TestClient

from palpate.server.security.accounts import Role
from palpate.store.importing.lines import line_of
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.server.conftest import KEY
from tests.server.packages import package
from tests.store.made_up import made_episode, squeeze

RECORDINGS, EPISODES = "/api/v1/recordings", "/api/v1/episodes"
OWNED, SENT = squeeze(1, owner="ann", visibility="lab"), squeeze(2, visibility="lab")
EXPLORED = made_episode(OWNED, owner="ann", visibility="lab")
TOMORROW = (datetime.now(UTC) + timedelta(days=1)).replace(microsecond=0)
Token = Callable[..., dict[str, str]]
OPERATIONS: list[tuple[str, str, Any]] = [
    ("PATCH", "", {"visibility": "lab"}),
    ("POST", "/undo", None),
    ("GET", "/history", None),
]


@pytest.fixture(autouse=True)
def world(store: Store) -> None:
    store.put(OWNED)
    store.put(SENT, uploader="robot")
    put_episode(store, EXPLORED)


@pytest.fixture(params=["recording", "episode"])
def address(request: pytest.FixtureRequest) -> str:
    """Of something that is ann's."""
    return f"{RECORDINGS}/{OWNED.id}" if request.param == "recording" else f"{EPISODES}/{EXPLORED.id}"


def is_seen(client: TestClient, address: str, headers: dict[str, str] | None = None) -> bool:
    status = client.get(address, headers=headers).status_code
    assert status in (200, 404)
    return status == 200


def test_each_change_is_noted_and_can_be_taken_back(
    client: TestClient, store: Store, token: Token, address: str
) -> None:
    """Visibility and embargo, each by itself; undone in the reverse order; no content changes."""
    ann = token("ann")
    assert not is_seen(client, address)
    shared = client.patch(address, json={"visibility": "public"}, headers=ann).json()
    assert shared == {"visibility": "public", "embargoed_until": None}
    assert is_seen(client, address)
    hidden = client.patch(address, json={"embargoed_until": TOMORROW.isoformat()}, headers=ann).json()
    assert hidden["visibility"] == "public"
    assert datetime.fromisoformat(hidden["embargoed_until"]) == TOMORROW
    assert not is_seen(client, address)
    assert is_seen(client, address, ann)
    found = client.get(address, headers=ann).json()
    assert (found["visibility"], found["embargoed_until"]) == ("public", hidden["embargoed_until"])
    assert client.post(f"{address}/undo", headers=ann).json() == shared
    assert is_seen(client, address)
    assert client.post(f"{address}/undo", headers=ann).json()["visibility"] == "lab"
    assert client.post(f"{address}/undo", headers=ann).status_code == 422
    lines = client.get(f"{address}/history", headers=ann).json()["items"]
    assert [(one["after"]["visibility"], one["who"], one["undone_by"]) for one in lines] == [
        ("public", "ann", "ann"),
        ("public", "ann", "ann"),
    ]
    assert store.get(OWNED.id).digest == OWNED.digest
    assert get_episode(store, EXPLORED.id).digest == EXPLORED.digest
    assert list(verify(store)) == []


def test_who_may_share_what(client: TestClient, token: Token, address: str) -> None:
    """Its owner, and curators where they see it; for others who see it it is a 403, and for those who do not a 404."""
    token("root", Role.ADMIN)
    people = {
        "anonymous": ({}, 401),
        "reader": (token("reader", Role.READER), 403),
        "bob": (token("bob"), 403),
        "ann": (token("ann"), 200),
        "curator": (token("carl", Role.CURATOR), 200),
        "host": ({"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}, 200),
    }
    for person, (headers, status) in people.items():
        for method, path, body in OPERATIONS:
            found = client.request(method, f"{address}{path}", json=body, headers=headers)
            expected = 422 if (status, path) == (200, "/undo") else status
            assert found.status_code == expected, (person, method, path, found.text)
    client.patch(address, json={"visibility": "private"}, headers=people["ann"][0])
    for person, expected in (("bob", 404), ("curator", 404), ("ann", 200)):
        for method, path, body in OPERATIONS:
            found = client.request(method, f"{address}{path}", json=body, headers=people[person][0])
            assert found.status_code == (200 if person == "ann" else expected), (person, method, path)
            if person == "ann" and path == "/undo":
                client.patch(address, json={"visibility": "private"}, headers=people["ann"][0])


def test_what_names_no_owner_is_of_who_has_sent_it(client: TestClient, token: Token) -> None:
    """The sender shares it, and nobody else; who has sent what somebody else owns sees it and does not share it."""
    robot, bob, address = token("robot"), token("bob"), f"{RECORDINGS}/{SENT.id}"
    assert client.patch(address, json={"visibility": "public"}, headers=bob).status_code == 403
    assert client.patch(address, json={"visibility": "private"}, headers=robot).status_code == 200
    assert not is_seen(client, address, bob)
    assert is_seen(client, address, robot)
    told = [client.get(address, headers=headers).json().get("uploaded_by") for headers in (robot, {})]
    assert told == ["robot", None]


def test_a_page_without_an_owner_tells_who_has_sent_it(client: TestClient, store: Store, token: Token) -> None:
    """As the service does: to those who have an account."""
    public = squeeze(8, visibility="public")
    store.put(public, uploader="robot")
    stated = "<dt>Owner</dt><dd>not stated; sent by robot"
    for headers, is_told in ((token("bob"), True), ({}, False)):
        page = client.get(f"/recordings/{public.id}", headers=headers).text
        assert (stated in page, "<dt>Owner</dt><dd>not stated" in page) == (is_told, True)
    assert "<dt>Owner</dt><dd>ann" in client.get(f"/recordings/{OWNED.id}", headers=token("ann")).text


@pytest.mark.parametrize("way", ["put", "lines", "packages"])
def test_each_who_sends_the_same_has_it_as_if_they_alone_did(client: TestClient, token: Token, way: str) -> None:
    """What is private and names no owner is seen by all who have sent it; none learns that it was there."""
    one = squeeze(7)
    people = {name: token(name) for name in ("kim", "lee", "bob")}

    def sent(name: str) -> tuple[int, bool, str]:
        if way == "put":
            found = client.put(f"{RECORDINGS}/{one.digest}", content=package(one), headers=people[name])
            return found.status_code, found.json()["new"], found.json()["id"]
        if way == "packages":
            found = client.post(RECORDINGS, files={"one": package(one)}, headers=people[name])
        else:
            kind = {"Content-Type": "application/x-ndjson"}
            found = client.post(RECORDINGS, content=line_of(one), headers={**people[name], **kind})
        (item,) = found.json()["items"]
        return item["status"], item["new"], item["id"]

    first = sent("kim")
    assert first[:2] == (201, True)
    digest = client.get(RECORDINGS, headers=people["kim"]).json()["items"][0]["digest"]
    assert client.get(RECORDINGS, headers=people["lee"]).json()["items"][0]["digest"] != digest
    assert sent("lee") == first
    assert sent("lee") == sent("kim") == (200, False, first[2])
    for name in ("kim", "lee"):
        assert client.get(f"{RECORDINGS}/{digest}", headers=people[name]).json()["uploaded_by"] == name
        assert client.get(RECORDINGS, headers=people[name]).json()["items"][0]["digest"] == digest
        page = client.get(f"/recordings/{first[2]}", headers=people[name])
        assert page.status_code == 200
        assert ({"kim": "lee", "lee": "kim"}[name] in page.text.replace("kilogram", "")) is False
    assert not is_seen(client, f"{RECORDINGS}/{digest}", people["bob"])
    # who was first decides who else sees it
    wanted = {"visibility": "lab"}
    assert client.patch(f"{RECORDINGS}/{digest}", json=wanted, headers=people["lee"]).status_code == 403
    assert client.patch(f"{RECORDINGS}/{digest}", json=wanted, headers=people["kim"]).status_code == 200
    assert sent("bob")[:2] == (200, False)
    client.patch(f"{RECORDINGS}/{digest}", json={"visibility": "private"}, headers=people["kim"])
    assert is_seen(client, f"{RECORDINGS}/{digest}", people["bob"])


@pytest.mark.parametrize(
    "body",
    [
        {"visibility": "secret"},
        {"visibility": None},
        {"embargoed_until": "soon"},
        {"embargoed_until": "0001-01-01T00:00:00+14:00"},
        {"embargoed_until": "9999-12-31T23:59:59-12:00"},
        {"owner": "bob"},
    ],
)
def test_what_is_wrong_is_refused(client: TestClient, token: Token, address: str, body: dict[str, Any]) -> None:
    """With the field, and nothing is changed."""
    ann = token("ann")
    refused = client.patch(address, json=body, headers=ann)
    assert refused.status_code == 422
    assert next(iter(body)) in refused.text
    assert client.get(f"{address}/history", headers=ann).json()["items"] == []


def by_form(client: TestClient, address: str, headers: dict[str, str], **fields: str) -> int:
    page = address.removeprefix("/api/v1")
    sent = client.post(f"{page}/sharing", data=fields, headers={"Origin": "http://testserver", **headers})
    return sent.status_code


def test_a_page_shares_too(client: TestClient, store: Store, token: Token) -> None:
    """A form without JavaScript, for those who may; one that is sent again unchanged ends no embargo earlier."""
    ann, bob, address = token("ann"), token("bob"), f"{RECORDINGS}/{OWNED.id}"
    client.follow_redirects = False
    assert "Who may see it" in client.get(f"/recordings/{OWNED.id}", headers=ann).text
    assert "Who may see it" not in client.get(f"/recordings/{OWNED.id}", headers=bob).text
    exact = TOMORROW.replace(second=30)
    client.patch(address, json={"visibility": "public", "embargoed_until": exact.isoformat()}, headers=ann)
    page = client.get(f"/recordings/{OWNED.id}", headers=ann).text
    until = exact.strftime("%Y-%m-%dT%H:%M")
    assert f'value="{until}"' in page
    assert by_form(client, address, ann, do="share", visibility="lab", until=until) == 303
    assert client.get(address, headers=ann).json()["visibility"] == "lab"
    assert store.get(OWNED.id).embargoed_until == exact
    assert by_form(client, address, ann, do="share", visibility="lab", until="") == 303
    assert store.get(OWNED.id).embargoed_until is None
    assert by_form(client, address, ann, do="undo") == 303
    assert store.get(OWNED.id).embargoed_until == exact
    assert by_form(client, address, ann, do="share", visibility="lab", until="soon") == 422
    assert by_form(client, address, ann, do="share", visibility="secret", until="") == 422
    assert by_form(client, address, bob, do="share", visibility="public", until="") == 404
    assert by_form(client, f"{EPISODES}/{EXPLORED.id}", ann, do="share", visibility="public", until="") == 303
    assert is_seen(client, f"{EPISODES}/{EXPLORED.id}")


def test_a_page_shows_the_form_again_with_what_is_wrong(client: TestClient, store: Store, token: Token) -> None:
    """What was typed stands in it, with a sentence in the words of the form; nothing changes."""
    headers = {**token("ann"), "Origin": "http://testserver", "Accept": "text/html"}
    for page in (f"/recordings/{OWNED.id}", f"/episodes/{EXPLORED.id}"):
        for fields, sentence in (
            ({"visibility": "public", "until": "9999-12-31T00:00"}, "found the year 9999, expected one after 1970"),
            ({"visibility": "public", "until": "soon"}, "found &#39;soon&#39;, expected a date and a time"),
            ({"visibility": "secret", "until": "2098-01-01T00:00"}, "Who may see it: found &#39;secret&#39;"),
        ):
            sent = client.post(f"{page}/sharing", data={"do": "share", **fields}, headers=headers)
            assert sent.status_code == 422
            assert re.search(f'role="alert">[^<]*{sentence}', sent.text), sent.text
            assert f'value="{fields["until"]}"' in sent.text
            assert f'action="{page}/sharing"' in sent.text
            assert f'href="{page}"' in sent.text
            assert "Unprocessable" not in sent.text
    assert (store.get(OWNED.id).visibility, store.get(OWNED.id).embargoed_until) == ("lab", None)


def test_a_page_tells_what_an_embargo_was_before(client: TestClient, token: Token) -> None:
    """Both sides of a change say until when it was, or is, kept back."""
    ann, address = token("ann"), f"{RECORDINGS}/{OWNED.id}"
    for until in ("2098-01-02T03:04:00Z", "2099-01-02T03:04:00Z", None):
        body = {"visibility": "public", "embargoed_until": until}
        assert client.patch(address, json=body, headers=ann).status_code == 200
    page = client.get(f"/recordings/{OWNED.id}", headers=ann).text
    told = re.findall(r"ann: (public[^<]*?) became (public[^<]*?)</li>", page)
    years = [tuple(re.findall(r"not before (\d{4})", side) for side in sides) for sides in told]
    assert years[:2] == [(["2099"], []), (["2098"], ["2099"])]


def test_another_site_shares_nothing(client: TestClient) -> None:
    """A form on a page of somebody else does nothing, whoever looks at that page."""
    headers = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://evil.example"}
    assert by_form(client, f"{RECORDINGS}/{OWNED.id}", headers, do="share", visibility="public", until="") == 403
    assert client.patch(f"{RECORDINGS}/{OWNED.id}", json={"visibility": "public"}, headers=headers).status_code == 403
    assert not is_seen(client, f"{RECORDINGS}/{OWNED.id}")
