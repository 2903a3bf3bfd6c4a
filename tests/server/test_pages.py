"""Pages show what the store holds, and read without JavaScript."""

import re
from dataclasses import replace
from functools import partial
from html import escape, unescape
from html.parser import HTMLParser
from typing import Any
from urllib.parse import quote

import pytest
from fastapi.testclient import TestClient

from palpate.server.example import add_example
from palpate.server.pages.templates import entry_text
from palpate.store.counting import counted
from palpate.store.describing import change_thing
from palpate.store.entries import Bound, Distribution, FailedEntry, Interval, Value
from palpate.store.errors import StoreError
from palpate.store.records import Device, FileItem, Pose, Recording, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.verifying import verify
from palpate.store.viewing import Viewer
from tests.server.conftest import KEY
from tests.store.made_up import squeeze

HOST = {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}
VOID = {"meta", "link", "img", "input", "br", "hr"}


class Outline(HTMLParser):
    """Elements that are open, links, and what screen readers need."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.faults: list[str] = []
        self.headings: list[str] = []
        self.feed(text)
        self.faults += [f"{tag} is not closed" for tag in self.open]

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = dict(attributes)
        if tag not in VOID:
            self.open.append(tag)
        if tag in ("a", "link", "img", "script", "form", "audio"):
            self.links += [value for name, value in attributes if name in ("href", "src", "action") and value]
        if tag == "img" and "alt" not in found:
            self.faults.append("an image without words")
        if tag == "svg" and not ({"aria-label", "aria-hidden"} & found.keys()):
            self.faults.append("a plot without words")
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(tag)
        if tag == "script" and "src" not in found:
            self.faults.append("a script in the page")
        self.faults += [f"style in {tag}" for name in found if name == "style" or name.startswith("on")]

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes nothing")


def test_an_empty_store_says_how_to_begin(client: TestClient) -> None:
    """The public is told that there is nothing to see; whoever started the server gets the example data."""
    assert "Nothing is here yet" in client.get("/").text
    assert "Add the example data" not in client.get("/").text
    assert "Add the example data" in client.get("/", headers=HOST).text


def test_every_page_of_the_example(client: TestClient, store: Store) -> None:
    """From the first page all links lead to pages of this site that are there and well formed."""
    add_example(store, count=40)
    seen, todo = set[str](), ["/"]
    while todo:
        address = todo.pop()
        # of pages that differ by a number only, some will do
        kind = re.sub(r"[0-9a-f-]{36}|[0-9a-f]{64}|(?<=objects/)[^?]+|cursor=.*|(?<=step=)\d+", "*", address)
        if address in seen or sum(one.endswith(f" {kind}") for one in seen) >= 3:
            continue
        seen |= {address, f"{len(seen)} {kind}"}
        found = client.get(address, headers={"Accept": "text/html"})
        assert found.status_code == 200, address
        if "text/html" not in found.headers["content-type"]:
            continue
        outline = Outline(found.text)
        assert not outline.faults, (address, outline.faults)
        assert outline.headings[0] == "h1", address
        assert outline.headings.count("h1") == 1
        for link in outline.links:
            if link.startswith("http"):
                assert link.startswith(("https://www.rfc-editor.org/", "https://doi.org/")), link
            elif not link.startswith("#"):
                todo.append(link if link.startswith("/") else f"{address.partition('?')[0]}{link}")
    for part in (
        "/episodes/",
        "/recordings/",
        "/setups/",
        "/objects/ycb",
        "/compare/table.csv",
        "/guides/api",
        "/guides/watch",
        "/guides/accounts",
        "step=",
    ):
        assert any(part in address for address in seen), part


def test_the_example_is_whole_and_marked(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is simulated says so, in its data set and in each recording; done again nothing is added."""
    # as the 2,000 take their time
    monkeypatch.setattr("palpate.server.pages.home.add_example", partial(add_example, count=60))
    assert client.post("/example", headers=HOST, follow_redirects=False).status_code == 303
    counts = counted(store, Viewer())
    assert counts.recordings > 60
    assert counts.grippers == 5
    assert counts.episodes == 1
    assert not list(verify(store))
    add_example(store, count=10)
    assert counted(store, Viewer()) == counts
    for row in client.get("/api/v1/recordings?dataset=simulated&limit=500").json()["items"]:
        assert row["notices"][0].startswith("simulated")
    assert client.get("/").text.count("simulated") > 5


def test_the_first_page_shows_simulated_objects_where_few_others_are(client: TestClient, store: Store) -> None:
    """Five objects, those first that were not simulated."""
    made, real = ([ThingRef(dataset, f"cup{place}") for place in range(5)] for dataset in ("simulated", "ycb"))
    for number, thing in enumerate((*made, *real), 1):
        store.put(squeeze(number, thing=thing, visibility="public"))
        cards = client.get("/").text.partition('<ul class="cards">')[2].partition("</ul>")[0]
        shown = dict.fromkeys(re.findall("/objects/((?:simulated|ycb)/cup[0-9])", cards))
        first = [*real[: max(0, number - 5)], *made[:number]][:5]
        assert list(shown) == [f"{one.dataset}/{one.id}" for one in first]


def test_an_objects_page_has_each_value_against_the_truth(client: TestClient, store: Store) -> None:
    """A point for each value, by what measured it, with its SD; the truth as a line, in the same unit."""
    cup = ThingRef("lab", "cup")

    def measured(number: int, gripper: str, value: float) -> Recording:
        setup = Setup(gripper=Device("gripper", gripper))
        return squeeze(number, visibility="public", thing=cup, setup=setup, entries=(Value("mass", value, 2.0, "g"),))

    store.put_many([measured(1, "left", 100.0), measured(2, "left", 104.0), measured(3, "right", 118.0)])
    change_thing(store, cup, lambda thing: thing.knowing(Value("mass", 0.11, unit="kg"), "our scale"))
    page = client.get("/objects/lab/cup").text
    assert page.count('class="dot') == 3
    assert "102, n = 2" in page
    assert "118, n = 1" in page
    assert "true: 110" in page
    assert "118 ± 2 g" in page
    table = client.get("/compare/table.csv?property=mass").text.splitlines()
    assert table[1].split(",")[:5] == ["left", "lab", "cup", "g", "2"]
    assert [float(line.rsplit(",", 1)[1]) for line in table[1:]] == pytest.approx([-8.0, 8.0])


def test_what_is_known_twice_is_told_apart_on_an_objects_page(client: TestClient, store: Store) -> None:
    """Each line has a label that is whole and says whose it is; what is known to be true is counted as that."""
    cup, scale = ThingRef("lab", "cup"), Setup(gripper=Device("gripper", "left"))
    fields: dict[str, Any] = {"visibility": "public", "thing": cup, "setup": scale}
    weighed = [squeeze(one, **fields, entries=(Value("mass", 118.0 + one, 2.0, "g"),)) for one in range(4)]
    typed = squeeze(9, **fields, owner="robot7", ground_truth=True, entries=(Value("mass", 999.0, unit="g"),))
    store.put_many([*weighed, typed])
    change_thing(store, cup, lambda thing: thing.knowing(Value("mass", 0.12, unit="kg"), "our scale"))
    page = client.get("/objects/lab/cup").text
    labels = re.findall(r'<text x="([\d.]+)" y="([\d.]+)" class="truth-label" text-anchor="(\w+)">([^<]*)<', page)
    assert [(anchor, label) for *_, anchor, label in labels] == [
        ("end", "true: 999 (robot7)"),
        ("start", "true: 120 (our scale)"),
    ]
    (top,) = {float(one) for one in re.findall(r'<line x1="[\d.]+" y1="([\d.]+)" [^>]*class="grid"', page)[:1]}
    assert all(float(y) < top for _, y, *_ in labels)
    assert "5 results, 1 of them known to be true" in page
    assert "the dashed lines are what is known to be true" in page
    # alone it is no line of a plot
    bowl = ThingRef("lab", "bowl")
    store.put(squeeze(10, **{**fields, "thing": bowl}, ground_truth=True, entries=typed.entries))
    page = client.get("/objects/lab/bowl").text
    assert "1 result, known to be true" in page
    assert re.search(r"1 result: <a [^>]*>999 g</a>", page)


def test_a_number_without_a_unit_is_on_an_objects_page(client: TestClient, store: Store) -> None:
    """As it was given, and that no unit was stated."""
    store.put(squeeze(1, visibility="public", thing=ThingRef("lab", "cup"), entries=(Value("holes", 3.0),)))
    assert re.search(r"1 result: <a [^>]*>3 \(unit not stated\)</a>", client.get("/objects/lab/cup").text)


def test_what_the_service_has_is_told_without_marks(client: TestClient) -> None:
    """Names in descriptions are set as code."""
    told = client.get("/guides/api").text
    assert "`" not in told
    assert "<code>~2f</code>" in told


def test_what_scrolls_in_a_box_is_reached_by_keyboard(client: TestClient, store: Store) -> None:
    """Each table and plot that may be wider than the page; and the small menu has what the wide one has."""
    add_example(store, count=10)
    for address in ("/", "/recordings", "/devices", "/compare?property=elasticity", "/objects/simulated/banana_ycb"):
        page = client.get(address).text
        boxes = re.findall(r'<[^>]*class="wide[^>]*>', page)
        assert boxes, address
        assert all('tabindex="0"' in one for one in boxes), address
        wide, small = (
            re.findall(r'href="([^"]*)"', one) for one in re.findall(r"<nav aria-label=.M.*?</nav>", page, re.S)
        )
        assert wide == small


def test_one_file_and_a_frame_that_is_not_stated_read_well(client: TestClient, store: Store) -> None:
    """One is no several, and what is not stated is no name of a frame."""
    files, pose = (FileItem("a.txt", "text/plain", b"a"),), Pose((0.5, 0.0, 0.25), None, "unstated", {})
    stated = squeeze(2, visibility="public", object_pose=replace(pose, frame="base"))
    store.put_many([odd := squeeze(1, visibility="public", files=files, object_pose=pose), stated])
    assert ": has 1 file, and none at 7" in client.get(f"/api/v1/recordings/{odd.id}/files/7").text
    assert "<dd>0.5, 0, 0.25 m (frame not stated)</dd>" in client.get(f"/recordings/{odd.id}").text
    assert "<dd>0.5, 0, 0.25 m in base</dd>" in client.get(f"/recordings/{stated.id}").text


def test_errors_are_pages_for_people(client: TestClient) -> None:
    """Who asks for a page gets the error as one, and a program gets it as JSON."""
    page = client.get("/recordings/nothing", headers={"Accept": "text/html"})
    assert (page.status_code, page.headers["content-type"]) == (404, "text/html; charset=utf-8")
    assert "is no id and no digest" in page.text
    assert client.get("/recordings/nothing").headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    ("entry", "expected"),
    [
        (Value("mass", 0.0, None, None), "0 (unit not stated)"),
        (Interval("mass", 1.0, 2.0, "g"), "1 to 2 g"),
        (Bound("mass", below=2.0, unit="g"), "below 2 g"),
        (Distribution("material", {"wood": 0.2, "foam": 0.8}), "foam 80%, wood 20%"),
        (FailedEntry("no contact", "mass"), "failed: no contact"),
    ],
)
def test_results_in_words(entry: object, expected: str) -> None:
    """Each kind of result reads as what it is."""
    assert entry_text(entry) == expected  # type: ignore[arg-type]


def test_long_names_and_those_that_turn_round_stay_in_their_place(client: TestClient, store: Store) -> None:
    """They are clipped, with the whole in a title; what an older store has kept has escapes, and turns nothing."""
    name, device = "\u202e" + "cup" * 1000, Device("gripper", "g" * 5000)
    old = squeeze(7, thing=ThingRef("lab", name), setup=Setup(gripper=device), visibility="public")
    with pytest.raises(StoreError, match="RIGHT-TO-LEFT OVERRIDE, which nobody sees"):
        store.put(old)
    store.put_checked([old])
    turned = name.replace("\u202e", "\\u202e")
    for address in ("/objects", "/recordings"):
        assert f'<bdi class="name" title="{turned}">{turned}</bdi>' in client.get(address).text
    assert f'<bdi class="name" title="{device.name}">' in client.get("/devices").text
    style = client.get("/objects").text.partition('rel="stylesheet" href="')[2].partition('"')[0]
    (rule,) = re.findall(r"^\.name \{(.*)\}$", client.get(style).text, re.MULTILINE)
    assert "unicode-bidi: isolate" in rule
    assert "line-clamp: 3" in rule


def test_a_squeeze_that_is_not_drawn_as_one_says_why(client: TestClient, store: Store) -> None:
    """On the page of the recording, below the name of the series."""
    recording = squeeze(visibility="public")
    store.put(recording)
    page = client.get(f"/recordings/{recording.id}").text
    assert "Stress over strain is not drawn: force has 3 numbers in each sample, expected one." in page


def test_the_example_is_seen_and_heard_and_its_story_is_told(client: TestClient, store: Store) -> None:
    """A trick that is found out, with what is known beside what is believed; a sound and a drawing, said to be made."""
    add_example(store, count=10)
    episode = client.get("/api/v1/episodes").json()["items"][0]["id"]
    page = client.get(f"/episodes/{episode}").text
    assert "A trick: to a camera it looks like banana" in page
    assert "Expected least was" in page
    assert re.search(r"Known: fruit .*✓ found: the most probable, \d+%", page)
    assert re.search(r"Known: soft-plastic .*✓ found: the most probable", page)
    first = client.get(f"/episodes/{episode}?step=1").text
    assert "✗ not found" in first
    knock = client.get("/api/v1/recordings?action=knocking").json()["items"]
    assert len(knock) >= 5
    shown = client.get(f"/recordings/{knock[0]['id']}").text
    assert "<audio" in shown
    assert "pitch [kHz]" in shown
    assert 'alt="simulated drawing.png"' in shown
    assert "nothing was knocked on" in shown


def test_what_is_asked_twice_stays_asked(client: TestClient, store: Store) -> None:
    """On the next page, on the first one again, and by a form that has no field for it."""
    twice = (Distribution("material", {"wood": 1.0}), Distribution("category", {"cube": 1.0}))
    store.put_many([squeeze(number, entries=twice, visibility="public", ground_truth=True) for number in range(3)])
    asked = ["known=material%3Awood", "known=category%3Acube"]
    for address, kind in (("/recordings", "recording"), ("/objects", "object")):
        first = client.get(f"{address}?{'&'.join(asked)}&text=made&limit=1").text
        (following,) = re.findall(r'rel="next" href="([^"]*)"', first)
        query = unescape(following).partition("?")[2].split("&")
        assert [part for part in query if not part.startswith("cursor=")] == [*asked, "text=made", "limit=1"], kind
        again = client.get(unescape(following)).text
        (back,) = re.findall(r'<a href="([^"]*)">First page', again)
        assert unescape(back) == f"{address}?{'&'.join(asked)}&text=made&limit=1"
        hidden = re.findall(r'<input type="hidden" name="([^"]*)" value="([^"]*)">', again.partition("<h1>")[2])
        assert hidden == [("known", "material:wood"), ("known", "category:cube"), ("limit", "1")]


HIDES = "cup\u202e\u2066 1"
SEEN = "cup\\u202e\\u2066 1"


def test_hidden_letters_of_older_stores_are_seen_on_every_page(client: TestClient, store: Store) -> None:
    """Lists, pages, pictures and figures have escapes; what programs get, and forms send back, is as it was."""
    thing = ThingRef("lab\u200e", HIDES, "m\u200b", HIDES, aliases=(HIDES,))
    setup = Setup(gripper=Device("gripper", HIDES), other=(Device("other", HIDES, HIDES),))
    old = [squeeze(n, thing=thing, setup=setup, owner=HIDES, visibility="public", log=f"{HIDES}\n") for n in range(3)]
    store.put_checked(old)
    address = client.get("/api/v1/objects").json()["items"][0]["url"].removeprefix("/api/v1")
    pages = ["/", "/objects", "/recordings", address, f"/recordings/{old[0].id}", "/devices", "/benchmark"]
    pages += [f"/compare?property=elasticity&object=lab%E2%80%8E/{quote(HIDES)}", f"{address}/edit"]
    for page in pages:
        found = client.get(page, headers={**HOST, "Accept": "text/html"})
        assert found.status_code == 200, page
        without_forms = re.sub(r'value="[^"]*"|<textarea.*?</textarea>', "", found.text, flags=re.DOTALL)
        assert not {"\u202e", "\u2066", "\u200e", "\u200b"} & set(without_forms), page
    assert SEEN in client.get(address).text
    assert f'<pre class="log" tabindex="0">{SEEN}\n' in client.get(f"/recordings/{old[0].id}").text
    assert client.get(f"/api/v1{address}").json()["aliases"] == [HIDES]
    form = client.get(f"{address}/edit", headers=HOST).text
    assert f'name="common_name" value="{HIDES}"' in form
    assert HIDES in form.partition("<textarea")[2].partition("</textarea>")[0]
    figures = re.findall(r'data-figure="([^"]*)"', client.get(address).text)
    assert figures
    for figure in figures:
        assert "\\u202e" not in client.get(unescape(figure)).text.replace("\\\\u202e", "")


def test_recordings_are_found_by_a_part_of_the_name_of_their_object(client: TestClient, store: Store) -> None:
    """In any case: of one object at once, several are offered with what else was asked; a whole name is exact."""
    cups = [ThingRef("lab", name, common_name=common) for name, common in (("cup", None), ("cup2", "Blue Tasse"))]
    store.put_many(squeeze(place, thing=thing, visibility="public") for place, thing in enumerate(cups))
    store.put(squeeze(5, thing=ThingRef("lab", "cup3"), visibility="private", owner="ann"))
    whole = client.get("/recordings?object=cup").text
    assert whole.count("<tr>") == 2
    assert "/objects/lab/cup2" not in whole
    for asked in ("tass", "TASSE", "LAB/blue", "cup2"):
        one = client.get(f"/recordings?action=squeezing&object={asked}")
        assert one.status_code == 200
        assert one.url.params["action"] == "squeezing"
        assert one.text.count("<tr>") == 2
        assert 'href="/objects/lab/cup2"' in one.text
    several = unescape(client.get("/recordings?action=squeezing&object=CU").text)
    assert several.count("<tr>") == 0
    offered = re.findall(r'href="(/recordings\?[^"]*object=[^"]*)"', several)
    assert offered == [f"/recordings?action=squeezing&object=lab%2F{name}" for name in ("cup", "cup2")]
    assert "called exactly CU" in several
    # nothing is offered of what is not seen, and nothing leads in a circle
    for asked in ("object=cup3", "object=no+such", "object=lab/cup&action=knocking", "object=cup2&action=knocking"):
        none = client.get(f"/recordings?{asked}")
        assert (none.status_code, "No recording fits" in none.text) == (200, True), asked


def choices_of(text: str, name: str) -> list[tuple[str, bool]]:
    """What a page offers to choose of, and whether it is chosen."""
    (found,) = re.findall(rf'<select name="{name}">(.*?)</select>', text)
    options = re.findall(r'<option(?: value="([^"]*)")?( selected)?>', found)
    return [(unescape(value), bool(selected)) for value, selected in options]


def test_recordings_are_filtered_by_what_is_seen_of_them(client: TestClient, store: Store) -> None:
    """Actions, properties and grippers are chosen of those that are seen; what is none stays asked, and says so."""
    hidden = Setup(gripper=Device("gripper", "secret hand"))
    weighed = replace(squeeze(1), action="weighing", entries=(Value("mass", 3.0, 1.0, "g"),))
    store.put_many([squeeze(0, visibility="public"), replace(weighed, visibility="public")])
    secret = (Value("secrecy", 3.0, 1.0, "g"),)
    store.put(squeeze(2, action="hiding", setup=hidden, entries=secret, visibility="private", owner="ann"))
    seen = {"action": ["", "squeezing", "weighing"], "property": ["", "elasticity", "mass"]}
    seen["gripper"] = ["", "two_finger"]
    unseen = {"action": "hiding", "property": "secrecy", "gripper": "secret hand"}
    public, host = client.get("/recordings").text, client.get("/recordings", headers=HOST).text
    for name, expected in seen.items():
        assert [value for value, _ in choices_of(public, name)] == expected, name
        assert sorted(value for value, _ in choices_of(host, name)) == sorted([*expected, unseen[name]]), name
        for asked in expected[1:]:
            text = client.get("/recordings", params={name: asked}).text
            assert [value for value, selected in choices_of(text, name) if selected] == [asked]
            assert text.count("<tr>") > 1
        for asked in (unseen[name], "no <such>"):
            text = client.get("/recordings", params={name: asked}).text
            assert (asked, True) in choices_of(text, name)
            assert f"{escape(asked)} (none)" in text
            assert "No recording fits" in text
    text = client.get("/objects?gripper=secret+hand").text
    assert ("secret hand", True) in choices_of(text, "gripper")


def test_bars_of_labels_say_what_they_count(client: TestClient, store: Store) -> None:
    """Results, by their most probable label."""
    wood = Distribution("material", {"wood": 0.9, "foam": 0.1})
    store.put_many(squeeze(n, thing=ThingRef("lab", "cup"), visibility="public", entries=(wood,)) for n in range(3))
    page = client.get("/objects/lab/cup").text
    assert re.search(r"In how many results each label is the most probable one\.</p>\s*<ul class=\"bars\">", page)
    assert '<span class="number">3</span>' in page
