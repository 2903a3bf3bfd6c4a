"""The page that compares devices: its colours, and what it says of what it cannot show."""

import re
from dataclasses import replace
from uuid import UUID

from fastapi.testclient import TestClient

from palpate.server.plots.colours import page_colours
from palpate.store.describing import change_thing
from palpate.store.entries import Bound, Entry, FailedEntry, Interval, Value
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from tests.store.made_up import squeeze

CUP = ThingRef("lab", "cup")


WEIGHED = Value("mass", 12.0, 1.0, "g")


def measured(number: int, gripper: str, thing: ThingRef = CUP, entry: Entry = WEIGHED) -> Recording:
    setup = Setup(gripper=Device("gripper", gripper))
    return squeeze(number, visibility="public", thing=thing, setup=setup, entries=(entry,))


def test_a_device_has_one_colour_on_a_page(client: TestClient, store: Store) -> None:
    """In curves, their key, the table and the errors, in pictures and in figures, whichever was measured last."""
    store.put_many([measured(1, "left"), measured(2, "right"), measured(3, "middle"), measured(4, "left")])
    change_thing(store, CUP, lambda thing: thing.knowing(Value("mass", 10.0, unit="g"), "a scale"))
    page = client.get("/compare?property=mass&object=lab/cup").text
    keys = re.findall(r'class="dot c(\d)"/>(?:</svg>)? *(?:</svg>)? (\w+)', page)
    assert sorted({name for _, name in keys}) == ["left", "middle", "right"]
    assert len(set(keys)) == 3
    colours = {name: int(colour) for colour, name in keys}
    dots = re.findall(r'class="dot c(\d)"><title>(\w+):', page)
    assert {name: int(colour) for colour, name in dots} == colours
    assert {int(one) for one in re.findall(r'class="curve c(\d)"', page)} == set(colours.values())
    # one of two is laid over: its colour stays
    recording = re.findall(r'value="([0-9a-f-]{36})"[^>]*>\s*<svg[^>]*>[^/]*/></svg> right', page)[0]
    alone = client.get(f"/compare?property=mass&object=lab/cup&recording={recording}").text
    assert {int(one) for one in re.findall(r'class="curve c(\d)"', alone)} == {colours["right"]}
    address = re.findall(r'data-figure="(/compare/curves[^"]*)"', alone)[0].replace("&amp;", "&")
    assert f"colour={colours['right']}" in address
    drawn = page_colours(dark=False)[f"c{colours['right']}"]
    other = client.get(address.replace(f"colour={colours['right']}", "colour=7")).text
    assert (drawn in client.get(address).text, drawn in other) == (True, False)


def test_a_device_keeps_its_colour_from_page_to_page_and_when_others_come(client: TestClient, store: Store) -> None:
    """On the object's page, where not all devices are, in the comparison, and after devices that sort before it."""
    other = ThingRef("lab", "mug")
    store.put(measured(0, "left", other))
    store.put_many([measured(1, "right"), measured(2, "middle")])

    def colour_of(name: str) -> set[int]:
        for thing in (CUP, other):
            change_thing(store, thing, lambda thing: thing.knowing(Value("mass", 10.0, unit="g"), "a scale"))
        errors = client.get("/compare?property=mass").text
        found = re.findall(rf'class="dot c(\d)"><title>{name}:', errors)
        devices = re.findall(r'class="dot c(\d)"/></svg> (\w+)</span></td>', errors)
        page = client.get("/objects/lab/cup").text
        mean = re.findall(r'class="mean c(\d)"', page)
        rows = re.findall(r'<text[^>]*class="name"[^>]*>(\w+)<', page)
        found += [colour for colour, device in devices if device == name]
        found += [colour for device, colour in zip(rows, mean, strict=True) if device == name]
        return {int(one) for one in found}

    before = colour_of("right")
    assert len(before) == 1
    store.put(measured(3, "another"))
    assert colour_of("right") == before
    assert colour_of("another") != before


def test_of_more_than_eight_eight_are_drawn_and_all_stay_ticked(client: TestClient, store: Store) -> None:
    """Nothing that was chosen is lost, and the page says what it does not show."""
    ids = [store.put(measured(number, f"gripper{number}")).id for number in range(10)]
    asked = "&".join(f"recording={one}" for one in ids)
    found = client.get(f"/compare?property=mass&object=lab/cup&{asked}")
    assert found.status_code == 200
    assert found.text.count(" checked>") == 10
    assert len(re.findall(r'class="curve c\d"', found.text)) == 8
    assert "Eight at most are laid over each other: 2 of those that you chose are not." in found.text
    assert (
        "are laid over each other"
        not in client.get(
            f"/compare?property=mass&object=lab/cup&{asked.rpartition('&recording')[0].rpartition('&recording')[0]}"
        ).text
    )


def test_what_is_not_there_to_compare_is_said(client: TestClient, store: Store) -> None:
    """An object without values, a property that nobody measured, and a store without any."""
    nothing = "Nothing with a number and a unit was measured yet."
    assert nothing in client.get("/compare?property=nope").text
    store.put(measured(1, "left"))
    page = client.get("/compare?property=mass&object=x/y").text
    assert "No mass of x/y with a number and a unit was measured that you may see: these are all objects." in page
    assert ">cup</bdi></a>" in page
    page = client.get("/compare?property=nope").text
    assert "No property “nope” with a number and a unit was measured that you may see." in page
    assert '<option value="" selected disabled>choose one</option>' in page
    assert nothing not in page
    assert "choose one" not in client.get("/compare?property=mass").text
    assert "No mass of" not in client.get("/compare?property=mass&object=lab/cup").text


def test_recordings_that_are_not_there_to_lay_over_each_other_are_said(client: TestClient, store: Store) -> None:
    """Which, also those of others, and what is shown instead; where nothing was asked for nothing is missing."""
    own = store.put(measured(1, "left")).id
    hidden = store.put(replace(measured(2, "left"), visibility="private", owner="ann")).id
    address, last = "/compare?property=mass&object=lab/cup", "the last one of each device is shown"
    for missing in (UUID(int=9), hidden):
        alone = client.get(f"{address}&recording={missing}&recording={missing}").text
        assert f"No recording {missing} of this object has a mass that you may see: {last}." in alone
        assert alone.count(" checked>") == 1
        beside = client.get(f"{address}&recording={missing}&recording={own}").text
        assert f"No recording {missing} of this object has a mass that you may see." in beside
    assert f"No recording was chosen: {last}." in client.get(f"{address}&chosen=true").text
    for fine in (f"{address}&chosen=true&recording={own}", address):
        assert "No recording" not in client.get(fine).text
    assert '<input type="hidden" name="chosen" value="true">' in client.get(address).text
    only = "Recordings are laid over each other of one object"
    assert only in client.get(f"/compare?property=mass&recording={own}").text
    assert only not in client.get("/compare?property=mass").text


def test_the_table_of_one_object_is_that_of_one_object(client: TestClient, store: Store) -> None:
    """What is downloaded from its page has its rows only; from the page of all it has all."""
    store.put_many([measured(1, "left"), measured(2, "left", ThingRef("lab", "mug"))])
    for asked, names in (("", ["cup", "mug"]), ("&object=lab/cup", ["cup"])):
        page = client.get(f"/compare?property=mass{asked}").text
        (address,) = re.findall(r'href="(/compare/table.csv[^"]*)"', page)
        _, *rows = client.get(address.replace("&amp;", "&")).text.splitlines()
        assert [row.split(",")[2] for row in rows] == names
    _, *rows = client.get("/compare/table.csv?property=mass&object=lab/none").text.splitlines()
    assert rows == []


def test_the_dashed_line_is_explained_where_there_is_one(client: TestClient, store: Store) -> None:
    """Without a known value there is none."""
    store.put(measured(1, "left"))
    assert "dashed line" not in client.get("/objects/lab/cup").text
    change_thing(store, CUP, lambda thing: thing.knowing(Value("mass", 10.0, unit="g"), "a scale"))
    assert "the dashed line is what is known to be true." in client.get("/objects/lab/cup").text


def test_long_labels_of_plots_are_cut_and_told_whole(client: TestClient, store: Store) -> None:
    """At the left of a row and below the plot; short ones are as they are."""
    long, unknown = "w" * 200, Value("n" * 200, 1.0, unit="g")
    store.put_many([measured(1, long), measured(2, "left"), measured(3, "left", entry=unknown)])
    page = client.get("/objects/lab/cup").text
    assert f">{'w' * 23}…<title>{long}</title></text>" in page
    assert f">{'n' * 109}…<title>{'n' * 200} [g]</title></text>" in page
    assert ">left</text>" in page


def test_of_one_value_no_spread_is_told(client: TestClient, store: Store) -> None:
    """An SD that is not known is none of 0; and one is one."""
    store.put(measured(1, "left"))
    change_thing(store, CUP, lambda thing: thing.knowing(Value("mass", 10.0, unit="g"), "a scale"))
    page = client.get("/compare?property=mass").text
    assert "left: 2 g, n = 1" in page
    assert "errors of 1 device in mass" in page
    assert "1 value by 1 device<" in client.get("/objects/lab/cup").text
    store.put(measured(2, "left"))
    assert "left: 2 ± 0 g, n = 2" in client.get("/compare?property=mass").text


def test_bounds_are_told_with_their_numbers(client: TestClient, store: Store) -> None:
    """Those that read alike together; in the unit of the property."""
    bounds = [
        Bound("mass", above=20.0, unit="g"),
        Bound("mass", above=0.02, unit="kg"),
        Bound("mass", below=9, unit="g"),
    ]
    others: list[Entry] = [*bounds, Interval("mass", 3.0, 4.0, "g"), FailedEntry("slipped", "mass")]
    store.put_many([measured(number, "left", entry=one) for number, one in enumerate(others)])
    page = client.get("/objects/lab/cup").text
    assert "5 results: " in page
    assert ">above 20 g</a> (2 times)," in page
    for words in ("below 9 g", "3 to 4 g", "failed"):
        assert f">{words}</a>" in page
    assert ">above 20 g</a></li>" in client.get("/compare?property=mass&object=lab/cup").text


def test_the_first_page_shows_what_was_measured_before_what_was_simulated(client: TestClient, store: Store) -> None:
    """One real object comes first, though its data set comes last; the others fill the row."""
    refs = [*(ThingRef("simulated", f"thing{number}") for number in range(6)), ThingRef("ycb", "mug")]
    store.put_many([measured(number, "left", ref) for number, ref in enumerate(refs)])
    cards = client.get("/").text.partition('class="cards"')[2].partition("</ul>")[0].split('class="card"')[1:]
    assert len(cards) == 5
    assert ["simulated" in card for card in cards] == [False, True, True, True, True]
