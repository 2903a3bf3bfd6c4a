"""Changing objects over the network: by those who may, noted, and reversible; by pages as by the service."""

import re
from collections.abc import Callable
from html import unescape
from typing import Any

import pytest
from fastapi.testclient import TestClient

from palpate import __version__
from palpate.server.security.accounts import Role
from palpate.store.audit import history
from palpate.store.entries import Value
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing
from tests.server.conftest import KEY
from tests.store.made_up import squeeze

API = "/api/v1/objects"
CUP, MUG = ThingRef("lab", "cup"), ThingRef("lab", "mug")
Token = Callable[..., dict[str, str]]
MASS = {"kind": "value", "property": "mass", "value": 118.0, "sd": 1.0, "unit": "g"}


@pytest.fixture(autouse=True)
def objects(store: Store) -> None:
    """A cup that is ann's alone, and a mug that is hers and somebody else's."""
    store.put_many(
        [
            squeeze(1, thing=CUP, owner="ann", visibility="public"),
            squeeze(2, thing=MUG, owner="ann", visibility="public"),
            squeeze(3, thing=MUG, owner="bob", visibility="public"),
        ]
    )


def test_each_change_is_noted_and_can_be_taken_back(client: TestClient, store: Store, token: Token) -> None:
    """Describing, telling, forgetting, merging and splitting; undone in the reverse order."""
    carl = token("carl", Role.CURATOR)
    told = client.patch(f"{API}/lab/cup", json={"common_name": "blue cup", "aliases": ["tasse"]}, headers=carl).json()
    assert (told["common_name"], told["aliases"], told["maker"]) == ("blue cup", ["tasse"], None)
    client.put(f"{API}/lab/cup/known", json={"entry": MASS, "source": "our scale"}, headers=carl)
    assert find_thing(store, "lab/cup").known[0].entry == Value("mass", 118.0, 1.0, "g")
    client.delete(f"{API}/lab/cup/known?property=mass", headers=carl)
    assert not find_thing(store, "lab/cup").known
    merged = client.post(f"{API}/lab/cup/merge", json={"dataset": "lab", "name": "mug"}, headers=carl).json()
    assert (merged["name"], merged["recordings"]) == ("mug", 3)
    for _ in range(4):
        assert client.post(f"{API}/lab/cup/undo", headers=carl).status_code == 200
    assert client.post(f"{API}/lab/cup/undo", headers=carl).status_code == 422
    assert find_thing(store, "lab/cup").ref == CUP
    assert {one.who for one in history(store, CUP)} == {"carl"}
    lines = client.get(f"{API}/lab/cup/history", headers=carl).json()["items"]
    assert [one["what"] for one in lines] == ["merged", "changed", "changed", "changed"]
    assert {one["undone_by"] for one in lines} == {"carl"}


OPERATIONS: list[tuple[str, str, Any]] = [
    ("PATCH", "", {"maker": "somebody"}),
    ("PUT", "/known", {"entry": MASS, "source": "our scale"}),
    ("DELETE", "/known?property=mass", None),
    ("POST", "/merge", {"dataset": "lab", "name": "other"}),
    ("POST", "/split", None),
    ("POST", "/undo", None),
    ("GET", "/history", None),
]


def test_who_may_change_what(client: TestClient, store: Store, token: Token) -> None:
    """Curators everything they see, owners what is all theirs, others nothing; what is not seen is not there."""
    other = ThingRef("lab", "other")
    hidden = ThingRef("lab", "hidden")
    store.put_many([squeeze(4, thing=other, owner="ann"), squeeze(5, thing=hidden, owner="root")])
    people = {
        "nobody": {},
        "reader": token("reader", Role.READER),
        "bob": token("bob"),
        "ann": token("ann"),
        "carl": token("carl", Role.CURATOR),
        "root": token("root", Role.ADMIN),
    }
    allowed = {"cup": {"ann", "carl", "root"}, "mug": {"carl", "root"}, "hidden": {"root"}}
    for thing, who in allowed.items():
        for person, headers in people.items():
            for method, path, body in OPERATIONS:
                if path == "/merge" and person in who:
                    continue
                found = client.request(method, f"{API}/lab/{thing}{path}", json=body, headers=headers)
                if person == "nobody":
                    expected = {401}
                elif person == "reader":
                    expected = {403}
                elif thing == "hidden" and person != "root":
                    expected = {404}
                else:
                    # there may be nothing to split or to take back
                    expected = {200, 422} if person in who else {403}
                assert found.status_code in expected, (person, thing, method, path, found.text)
    # the other object of a merge is one that may be changed too, and is seen
    for headers, into in ((people["ann"], "mug"), (people["carl"], "hidden"), (people["carl"], "nothing")):
        found = client.post(f"{API}/lab/cup/merge", json={"dataset": "lab", "name": into}, headers=headers)
        assert found.status_code == (403 if into == "mug" else 422)
    assert find_thing(store, "lab/cup").merged_into is None


def test_nobody_learns_a_name_by_a_merge_unless_that_is_wanted(client: TestClient, store: Store, token: Token) -> None:
    """Who merges is told who would learn it, by form and by service; what nobody learns asks for nothing."""
    hidden, shared = ThingRef("lab", "hidden"), ThingRef("lab", "shared")
    store.put_many(
        [
            squeeze(4, thing=hidden, owner="ann", visibility="private"),
            squeeze(5, thing=shared, owner="ann", visibility="lab"),
        ]
    )
    ann = {**token("ann"), "Origin": "http://testserver", "Accept": "text/html"}
    fields = {"do": "merge", "into": "lab/hidden"}
    for name, others in (("cup", "everybody would"), ("shared", "everybody with an account would")):
        sent = {"dataset": "lab", "name": "hidden"}
        refused = client.post(f"{API}/lab/{name}/merge", json=sent, headers=ann)
        assert refused.status_code == 422
        assert f"{others} learn by this that there is lab/hidden" in refused.json()["errors"][0]["detail"]
        page = client.post(f"/objects/lab/{name}/edit", data=fields, headers=ann)
        assert page.status_code == 422
        assert f"Others may learn its name: {others} learn" in page.text
        assert 'value="lab/hidden"' in page.text
        assert client.get(f"{API}/lab/hidden").status_code == 404
    # to those who see both it is nothing new
    assert (
        client.post(f"{API}/lab/hidden/merge", json={"dataset": "lab", "name": "cup"}, headers=ann).status_code == 200
    )
    assert client.post(f"{API}/lab/hidden/split", headers=ann).status_code == 200
    client.follow_redirects = False
    wanted = client.post("/objects/lab/cup/edit", data={**fields, "shows_name": "yes"}, headers=ann)
    assert wanted.status_code == 303
    assert client.get(f"{API}/lab/hidden").json()["merged"] == [{"dataset": "lab", "name": "cup"}]


def test_an_owner_learns_no_name_of_another_owner_by_a_merge(client: TestClient, store: Store, token: Token) -> None:
    """Of two objects that are private, and seen by one alone who may merge them."""
    his, hers = ThingRef("lab", "his"), ThingRef("lab", "hers")
    store.put_many(
        [
            squeeze(4, thing=his, owner="bob", visibility="private"),
            squeeze(5, thing=hers, owner="ann", visibility="private"),
        ]
    )
    root, sent = token("root", Role.ADMIN), {"dataset": "lab", "name": "hers"}
    refused = client.post(f"{API}/lab/his/merge", json=sent, headers=root)
    assert "bob would learn by this that there is lab/hers" in refused.json()["detail"]
    merged = client.post(f"{API}/lab/his/merge", json={**sent, "shows_name": True}, headers=root)
    assert (merged.status_code, merged.json()["recordings"]) == (200, 2)


def test_what_is_hidden_from_who_merges_is_answered_as_what_is_not_there(
    client: TestClient, store: Store, token: Token
) -> None:
    """By the form and by the service: the same but for the name that they gave."""
    store.put(squeeze(4, thing=ThingRef("lab", "unseen"), owner="root", visibility="private"))
    carl = {**token("carl", Role.CURATOR), "Origin": "http://testserver", "Accept": "text/html"}
    answers = set()
    for name in ("unseen", "absent"):
        by_service = client.post(f"{API}/lab/cup/merge", json={"dataset": "lab", "name": name}, headers=carl)
        by_form = client.post("/objects/lab/cup/edit", data={"do": "merge", "into": f"lab/{name}"}, headers=carl)
        assert {by_service.status_code, by_form.status_code} == {422}
        main = by_form.text.partition("<main")[2].replace(name, "NAME")
        answers.add((by_service.text.replace(name, "NAME"), main))
    assert len(answers) == 1


@pytest.mark.parametrize(
    ("entry", "field"),
    [
        ({**MASS, "unit": "m"}, "known mass"),
        ({**MASS, "value": 1e999}, "known mass.value"),
        ({**MASS, "value": -118.0}, "value: found -118, expected more than 0"),
        ({**MASS, "unit": None}, "unit: is missing"),
        ({"kind": "distribution", "property": "mass", "probabilities": {"120": 1.0}}, "value: found the label '120'"),
        ({"kind": "value", "property": "material", "value": 5.0}, "material is a label"),
        ({"kind": "value", "property": "mass"}, "body.entry"),
        ({"kind": "failed", "reason": "broken"}, "known"),
        ({"kind": "distribution", "property": "material", "probabilities": {"wood": 0.5}}, "known material"),
        ({**MASS, "colour": "red"}, "body.entry.colour"),
    ],
)
def test_what_cannot_be_known_is_refused(
    client: TestClient, store: Store, token: Token, entry: dict[str, Any], field: str
) -> None:
    """With the field and the reason; nothing is changed."""
    import json

    body = json.dumps({"entry": entry, "source": "our scale"})
    carl = {**token("carl", Role.CURATOR), "Content-Type": "application/json"}
    client.put(f"{API}/lab/cup/known", json={"entry": MASS, "source": "first"}, headers=carl)
    refused = client.put(f"{API}/lab/cup/known", content=body, headers=carl)
    assert refused.status_code == 422
    assert field in refused.text
    assert [one.source for one in find_thing(store, "lab/cup").known] == ["first"]


def test_by_forms(client: TestClient, store: Store) -> None:
    """The forms of the page do the same, say what is wrong, and want to stand on a page of this site."""
    host = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}
    page = "/objects/lab/cup/edit"
    assert "Change what is said of it" in client.get("/objects/lab/cup", headers=host).text
    assert "Change what is said of it" not in client.get("/objects/lab/cup").text
    assert client.get(page).status_code == 401
    forms = client.get(page, headers=host).text
    assert set(re.findall(r'name="do" value="(\w+)"', forms)) == {"describe", "know", "merge", "undo"} - (
        set() if "Take back" in forms else {"undo"}
    )

    def send(**fields: str) -> Any:
        return client.post(page, data=fields, headers=host, follow_redirects=False)

    assert (
        send(do="describe", common_name="blue cup", maker="", aliases=" a, b \r\n\r\n c").headers["location"]
        == "/objects/lab/cup?saved=describe"
    )
    assert "The description was saved." in client.get("/objects/lab/cup?saved=describe", headers=host).text
    assert "<script" not in client.get("/objects/lab/cup?saved=<script", headers=host).text.partition("<main")[2]
    assert find_thing(store, "lab/cup").ref.aliases == ("a, b", "c")
    assert send(do="know", property="mass", value="118", sd="1", unit="g", source="our scale").status_code == 303
    assert send(do="know", property="material", value="ceramic", unit="", sd="", source="eye").status_code == 303
    assert len(find_thing(store, "lab/cup").known) == 2
    again = send(do="know", property="mass", value="119", sd="1", unit="g", source="our scale")
    assert again.headers["location"].endswith("?saved=replaced")
    assert "in place of what the same source said" in client.get(again.headers["location"], headers=host).text
    assert "replaced" in client.get(page, headers=host).text
    wrong = send(do="know", property="mass", value="heavy", sd="", unit="g", source="guess")
    assert wrong.status_code == 422
    assert "expected a number" in wrong.text
    for kept in ('name="value" value="heavy"', 'name="source" value="guess"', 'name="common_name" value="blue cup"'):
        assert kept in wrong.text
    nowhere = send(do="merge", into='nope"<')
    assert (nowhere.status_code, 'name="into" value="nope&#34;&lt;"' in nowhere.text) == (422, True)
    forgotten = send(do="know", property="mass", value="120", sd="", unit="", source="guess")
    assert "Unit: is missing, expected one of mass" in forgotten.text
    assert send(do="forget", property="material", source="eye").status_code == 303
    assert send(do="merge", into="lab/mug").status_code == 303
    assert find_thing(store, "lab/cup").merged_into == find_thing(store, "lab/mug").ref
    assert send(do="split").status_code == 303
    assert send(do="undo").status_code == 303
    assert send(do="burn").status_code == 422
    foreign = {**host, "Origin": "http://evil.example"}
    assert client.post(page, data={"do": "undo"}, headers=foreign).status_code == 403
    assert client.post(page, json={"do": "undo"}, headers=host).status_code == 415
    # the service listens to the browser's cookie too, and so must mind who sends it
    assert client.patch(f"{API}/lab/cup", json={"maker": "x"}, headers=foreign).status_code == 403
    assert client.patch(f"{API}/lab/cup", json={"maker": "x"}, headers={"Cookie": host["Cookie"]}).status_code == 403
    assert client.patch(f"{API}/lab/cup", json={"maker": "x"}, headers=host).status_code == 200


def test_what_is_not_there_cannot_be_taken_away(client: TestClient, store: Store, token: Token) -> None:
    """Forgetting what nobody says, or another source, is refused with what there is; nothing is noted."""
    carl, page = token("carl", Role.CURATOR), "/objects/lab/cup/edit"
    form = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}
    known = f"{API}/lab/cup/known"
    none = client.delete(f"{known}?property=nothing", headers=carl)
    assert (none.status_code, none.json()["detail"]) == (
        422,
        "property: nothing is known of 'nothing'; nothing is known of this object",
    )
    client.put(known, json={"entry": MASS, "source": "our scale"}, headers=carl)
    notes = len(history(store, CUP))
    for asked, told in (
        ({"property": "nothing"}, "property: nothing is known of 'nothing'; choose from 'mass'"),
        ({"property": "mass", "source": "nobody"}, "source: 'nobody' says nothing of 'mass'; choose from 'our scale'"),
    ):
        found = client.delete(known, params=asked, headers=carl)
        assert (found.status_code, found.json()["detail"]) == (422, told)
        sent = client.post(page, data={"do": "forget", **asked}, headers=form, follow_redirects=False)
        assert (sent.status_code, told in unescape(sent.text)) == (422, True)
    assert len(history(store, CUP)) == notes
    assert client.delete(known, params={"property": "mass", "source": "our scale"}, headers=carl).status_code == 200
    again = {"do": "forget", "property": "mass", "source": "our scale"}
    assert client.post(page, data=again, headers=form, follow_redirects=False).status_code == 422


@pytest.mark.parametrize("into", ["nothing", "", "lab/", "/cup"])
def test_what_names_no_object_cannot_be_merged_into(client: TestClient, token: Token, into: str) -> None:
    """The form says that data set and name are wanted, and what was found; the service too."""
    form = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}
    sent = client.post("/objects/lab/cup/edit", data={"do": "merge", "into": into}, headers=form)
    assert sent.status_code == 422
    told = f"Data set and name of the other one: found {into!r}, expected DATASET/NAME, such as ycb/025_mug"
    assert told in unescape(sent.text)
    dataset, _, name = into.partition("/")
    carl = token("carl", Role.CURATOR)
    asked = client.post(f"{API}/lab/cup/merge", json={"dataset": dataset, "name": name}, headers=carl)
    assert asked.status_code == 422
    assert "body." in asked.text


def test_a_page_tells_what_would_be_taken_back(client: TestClient, token: Token) -> None:
    """Each change with what was there before; the button tells which one is the last that holds, and whose it was."""
    host = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}
    bob, dora = token("bob", Role.CURATOR), token("dora", Role.CURATOR)

    def page() -> str:
        return client.get("/objects/lab/cup/edit", headers=host).text

    assert "Take back" not in page()
    client.patch(f"{API}/lab/cup", json={"common_name": "<cup>"}, headers=bob)
    client.patch(f"{API}/lab/cup", json={"common_name": "blue cup"}, headers=bob)
    client.post(f"{API}/lab/cup/merge", json={"dataset": "lab", "name": "mug"}, headers=dora)
    assert re.search(r"It takes back: merged by dora, [^<]*: into lab/mug\.", page())
    client.post(f"{API}/lab/cup/split", headers=dora)
    assert re.search(r"It takes back: changed by bob, [^<]*: common name: &lt;cup&gt; became blue cup\.", page())
    client.put(f"{API}/lab/cup/known", json={"entry": MASS, "source": "our scale"}, headers=dora)
    assert "changed by dora: known, mass, our scale: 118 ± 1 g added</li>" in page()
    for _ in range(3):
        client.post(f"{API}/lab/cup/undo", headers=dora)
    assert "It takes back" not in page()
    assert 'value="undo"' not in page()


def test_the_history_says_what_was_added_and_what_was_taken_away(client: TestClient, token: Token) -> None:
    """Each once, in words: also of what was there and is hidden from who reads it, which is not told."""
    carl = token("carl", Role.CURATOR)
    changes: list[dict[str, Any]] = [{"maker": "Acme", "aliases": ["tasse"]}, {"maker": "Acme Ltd"}]
    for change in (*changes, {"maker": None, "aliases": []}):
        assert client.patch(f"{API}/lab/cup", json=change, headers=carl).status_code == 200
    page = client.get("/objects/lab/cup/edit", headers=carl).text
    told = re.findall(r"<li>[^<]* by carl: ([^<]*)</li>", page)
    assert [sorted(line.split("; ")) for line in told] == [
        ["aliases, tasse: taken away", "maker: Acme Ltd taken away"],
        ["maker: Acme became Acme Ltd"],
        ["aliases, tasse: added", "maker: Acme added"],
    ]
    assert "nothing" not in page.partition("<main")[2]


def test_a_form_undoes_nothing_that_others_have_changed(client: TestClient, store: Store, token: Token) -> None:
    """What is saved from a page that no longer holds is refused, and keeps what was typed; saved again it is done."""
    host = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}
    page = "/objects/lab/cup/edit"

    def version(text: str) -> str:
        (found,) = re.findall(r'name="version" value="(\w+)"', text)
        return str(found)

    typed = {
        "do": "describe",
        "common_name": "mine",
        "maker": "",
        "aliases": "",
        "version": version(client.get(page, headers=host).text),
    }
    client.patch(f"{API}/lab/cup", json={"maker": "Acme"}, headers=token("carl", Role.CURATOR))
    refused = client.post(page, data=typed, headers=host, follow_redirects=False)
    assert refused.status_code == 409
    assert "was changed since this page was loaded" in refused.text
    assert 'value="mine"' in refused.text
    assert find_thing(store, "lab/cup").ref.maker == "Acme"
    again = {**typed, "maker": "Acme", "version": version(refused.text)}
    assert client.post(page, data=again, headers=host, follow_redirects=False).status_code == 303
    assert (find_thing(store, "lab/cup").ref.common_name, find_thing(store, "lab/cup").ref.maker) == ("mine", "Acme")


def test_the_foot_of_the_form_has_the_version_of_the_program(client: TestClient, store: Store, token: Token) -> None:
    """And the form that of the object."""
    store.put(squeeze(4, thing=ThingRef("lab", "mug"), owner="ann"))
    page = client.get("/objects/lab/mug/edit", headers=token("carl", Role.CURATOR)).text
    assert f">Palpate {__version__} ·" in page
    assert f'name="version" value="{__version__}"' not in page


def test_what_an_editor_does_not_see_stays(client: TestClient, store: Store, token: Token) -> None:
    """Words of a private recording are neither removed by whoever does not see them, nor told by what was before."""
    ann, carl = token("ann"), token("carl", Role.CURATOR)
    zeus = ThingRef("lab", "mug", "SecretCorp", "Zeus handle", {"patent": "US123"}, ("zeus-1",))
    store.put(squeeze(4, thing=zeus, owner="ann"))
    form = {"do": "describe", "common_name": "", "maker": "", "aliases": "pot"}
    page = "/objects/lab/mug/edit"
    sent = client.post(page, data=form, headers={**carl, "Origin": "http://testserver"}, follow_redirects=False)
    assert sent.status_code == 303
    held = find_thing(store, "lab/mug").ref
    assert (held.maker, held.common_name, held.attributes) == ("SecretCorp", "Zeus handle", {"patent": "US123"})
    assert set(held.aliases) == {"zeus-1", "pot"}
    seen = client.patch(f"{API}/lab/mug", json={"maker": "x", "attributes": {}}, headers=carl).json()
    assert (seen["maker"], seen["common_name"], seen["aliases"]) == ("x", None, ["pot"])
    for address in (f"{API}/lab/mug/history", page):
        told = client.get(address, headers=carl).text
        assert not [word for word in ("SecretCorp", "Zeus", "zeus", "US123") if word in told]
        assert "pot" in told
    assert client.post(f"{API}/lab/mug/undo", headers=carl).status_code == 200
    assert find_thing(store, "lab/mug").ref.maker == "SecretCorp"
    root = client.get(f"{API}/lab/mug", headers=token("root", Role.ADMIN)).json()
    assert (root["maker"], root["common_name"]) == ("SecretCorp", "Zeus handle")
    assert client.get(f"{API}/lab/mug", headers=ann).status_code == 200
