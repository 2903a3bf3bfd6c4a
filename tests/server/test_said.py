"""What a person has said of an object: nobody learns it, hides it or takes it over by sending something of its name."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from fastapi.testclient import TestClient

from palpate.server.security.accounts import Role
from palpate.store.describing import add_thing, change_thing, keep_image
from palpate.store.entries import Distribution, Value
from palpate.store.records import ThingRef
from palpate.store.store import Store
from tests.store.made_up import squeeze

API = "/api/v1/objects"
SECRET, MUG = ThingRef("lab", "secret"), ThingRef("ycb", "025_mug")
WOOD = Distribution("material", {"wood": 1.0})
Token = Callable[..., dict[str, str]]


def shown(client: TestClient, thing: ThingRef, headers: dict[str, str] | None = None) -> Any:
    """What is known of an object, whose it is, and how many pictures there are; None where it is not there."""
    found = client.get(f"{API}/{thing.dataset}/{thing.id}", headers=headers)
    assert found.status_code in (200, 404)
    if found.status_code == 404:
        return None
    one = found.json()
    return [part["source"] for part in one["known"]], one["maker"], len(one["images"])


def is_wooden(client: TestClient, headers: dict[str, str] | None = None) -> bool:
    """Whether anything is found that is known to be of wood."""
    asked = (f"{API}?known=material:wood", "/api/v1/recordings?known=material:wood")
    found = {bool(client.get(address, headers=headers).json()["items"]) for address in asked}
    assert len(found) == 1
    return found.pop()


@pytest.mark.parametrize("visibility", ["private", "public"])
def test_a_guessed_name_opens_nothing(client: TestClient, store: Store, token: Token, visibility: str) -> None:
    """What ann has said of what only she sees stays hers when bob sends something of that name; until she shares."""
    ann, bob, carl = token("ann"), token("bob"), token("carl", Role.CURATOR)
    sent = store.put(squeeze(1, thing=SECRET), uploader="ann")
    picture = keep_image(store, "a.png", "image/png", b"\x89PNG\r\n\x1a\n")
    change_thing(
        store,
        SECRET,
        lambda one: one.knowing(WOOD, "private scale").described(maker="Zeus").showing(picture),
        who="ann",
    )
    assert shown(client, SECRET, bob) is None
    store.put(squeeze(2, thing=SECRET, visibility=visibility), uploader="bob")
    others = (None, bob, carl) if visibility == "public" else (bob,)
    for person in others:
        assert shown(client, SECRET, person) == ([], None, 0)
        assert not is_wooden(client, person)
        assert not client.get(f"{API}?text=zeus", headers=person).json()["items"]
    assert client.get(f"{API}/lab/secret/images/0", headers=bob).status_code == 404
    assert shown(client, SECRET, ann) == (["private scale"], "Zeus", 1)
    assert is_wooden(client, ann)
    assert client.patch(f"/api/v1/recordings/{sent.id}", json={"visibility": "public"}, headers=ann).status_code == 200
    for person in others:
        assert shown(client, SECRET, person) == (["private scale"], "Zeus", 1)
        assert is_wooden(client, person)


@pytest.mark.parametrize("is_measured", [False, True])
def test_an_upload_hides_nothing_and_takes_nothing_over(
    client: TestClient, store: Store, token: Token, is_measured: bool
) -> None:
    """What a curator has said stays seen by all, and is the curator's to change, whatever somebody sends later."""
    bob, carl = token("bob"), token("carl", Role.CURATOR)
    add_thing(store, replace(MUG, maker="ACME", common_name="mug"), who="carl")
    if is_measured:
        store.put(squeeze(1, thing=MUG, visibility="public"), uploader="bob")
    change_thing(store, MUG, lambda one: one.knowing(Value("mass", 118.0, unit="g"), "our scale"), who="carl")
    store.put(squeeze(2, thing=MUG), uploader="bob")
    for person in (None, bob, carl):
        assert shown(client, MUG, person) == (["our scale"], "ACME", 0)
        assert client.get(f"{API}?text=acme", headers=person).json()["items"]
    found = client.get(API).json()["items"]
    assert [one["recordings"] for one in found] == [int(is_measured)]
    address = f"{API}/ycb/025_mug"
    assert client.delete(f"{address}/known?property=mass", headers=bob).status_code == 403
    assert client.patch(address, json={"maker": "bob inc"}, headers=bob).status_code == 403
    assert client.post(f"{address}/undo", headers=bob).status_code == 403
    assert client.post(f"{address}/undo", headers=carl).status_code == 200
    assert shown(client, MUG) == ([], "ACME", 0)


def test_an_owner_changes_what_they_alone_have_described(client: TestClient, store: Store, token: Token) -> None:
    """Until a curator has; what was taken back does not count."""
    ann, carl = token("ann"), token("carl", Role.CURATOR)
    store.put(squeeze(1, thing=SECRET, visibility="public"), uploader="ann")
    address = f"{API}/lab/secret"
    assert client.patch(address, json={"maker": "ann"}, headers=ann).status_code == 200
    assert client.patch(address, json={"maker": "Acme"}, headers=carl).status_code == 200
    refused = client.patch(address, json={"maker": "ann"}, headers=ann)
    assert (refused.status_code, "alone has described it" in refused.text) == (403, True)
    assert client.post(f"{address}/undo", headers=carl).status_code == 200
    assert client.patch(address, json={"maker": "Ann"}, headers=ann).status_code == 200
