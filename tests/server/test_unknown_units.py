"""Units that this program does not know, as a newer one may have kept them: no page breaks, and none counts wrongly."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from palpate.network import units
from palpate.store import schema
from palpate.store.describing import change_thing
from palpate.store.entries import Bound, Interval, Value
from palpate.store.errors import StoreError
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties
from palpate.store.things import find_thing
from palpate.store.undoing import undo
from palpate.store.verifying import verify
from tests.server.conftest import Headers
from tests.server.packages import package

T0 = datetime(2024, 5, 1, tzinfo=UTC)
CUP = ThingRef("lab", "cup")
PAGES: tuple[str, ...] = (
    "/",
    "/recordings",
    "/objects/lab/cup",
    "/benchmark",
    "/devices",
    "/api/v1/entries",
    "/api/v1/properties",
)
PAGES += tuple(f"/compare?property={name}" for name in ("fluff", "mass", "frob"))
PAGES += tuple(f"/compare/{what}?property=fluff" for what in ("table.csv", "plot.json"))
PAGES += ("/benchmark/errors.csv", "/benchmark/errors.json", "/objects/lab/cup/plot.json?property=fluff")
PAGES += ("/objects/lab/cup/plot.json?property=mass",)


def measured(number: int, *entries: Value | Bound | Interval, truth: bool = False, gripper: str = "hand") -> Recording:
    return Recording(
        T0 + timedelta(seconds=number),
        "weighing",
        CUP,
        setup=Setup(gripper=Device("gripper", gripper)),
        entries=entries,
        ground_truth=truth,
        visibility="public",
    )


@contextmanager
def newer(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A program that knows a unit more: seven grams are a blorb."""
    with monkeypatch.context() as patch:
        shipped = {**units._shipped(), "blorbs": units.Unit(0.007, units.unit_of("g").dimension)}
        patch.setattr(units, "_shipped", lambda: shipped)
        forget()
        yield
    forget()


def forget() -> None:
    units.unit_of.cache_clear()
    units.ask_pint.cache_clear()


@pytest.fixture
def odd(store: Store, monkeypatch: pytest.MonkeyPatch) -> Store:
    """A property in blorbs, and one in grams of which some is in blorbs."""
    with newer(monkeypatch):
        fluff = [Value("fluff", 3.0 + number, 0.5, "blorbs") for number in range(3)]
        for number, one in enumerate(fluff):
            store.put(measured(number, one, Bound("fluff", above=9.0, unit="blorbs")))
        store.put(measured(5, Value("mass", 21.0, unit="g"), Value("frob", 1.0, unit="g")))
        store.put(measured(6, Value("mass", 23.0, unit="g")))
        store.put(measured(7, Value("mass", 4.0, unit="blorbs")))
        store.put(measured(11, Value("grit", 6.0, unit="g")))
        store.put(measured(12, Value("grit", 5.0, unit="blorbs")))
        store.put(measured(8, Bound("mass", above=8.0, unit="blorbs"), gripper="claw"))
        store.put(measured(9, Value("fluff", 2.0, unit="blorbs"), truth=True))
        store.put(measured(10, Value("frob", 5.0, unit="g"), truth=True))
        change_thing(store, CUP, lambda thing: thing.knowing(Value("mass", 2.0, unit="blorbs"), "a scale"))
    entries = schema.entries.c
    grit = (entries.property == "grit", entries.unit == "blorbs")
    with store.engine.begin() as connection:
        # as where it was found to be of a wrong dimension
        connection.execute(update(schema.entries).where(*grit).values(value_si=None, sd_si=None))
    return store


def test_no_page_breaks_at_a_unit_that_is_not_known(odd: Store, client: TestClient) -> None:
    """Each answers, also about the properties that have it."""
    ids = {one["id"] for one in client.get("/api/v1/recordings").json()["items"]}
    assert len(ids) == 11
    pages = [*PAGES, *(f"/recordings/{id}" for id in ids), *(f"/api/v1/recordings/{id}/package" for id in ids)]
    found = {page: client.get(page, headers={"Accept": "text/html,*/*"}).status_code for page in pages}
    # there is no plot of what cannot be compared
    assert {page: status for page, status in found.items() if status != 200} == {
        "/compare/plot.json?property=fluff": 404
    }


def test_what_is_sent_in_another_unit_is_refused(odd: Store) -> None:
    """Nobody can tell whether grams are of the dimension of blorbs."""
    with pytest.raises(StoreError, match=r"entries\[0\].unit: unit 'g' is mass; expected the dimension that fluff has"):
        odd.put(measured(20, Value("fluff", 1.0, unit="g")))


def test_uploads_of_others_go_on(odd: Store, client: TestClient, token: Callable[..., Headers]) -> None:
    """What is sent of other properties is understood, and what is of such a one is told like by the store."""
    ann = {**token("ann"), "Origin": "http://testserver", "Accept": "text/html"}
    sent = [("good", Value("mass", 5.0, unit="g")), ("bad", Value("fluff", 5.0, unit="g"))]
    files = [("files", (f"{name}.zip", package(measured(30, one)))) for name, one in sent]
    found = client.post("/upload", files=files, headers=ann)
    assert found.status_code == 200
    assert "1 new recording" in found.text
    assert "expected the dimension that fluff has" in found.text


def test_the_store_tells_what_is_known_in_such_a_unit(odd: Store) -> None:
    """Tables of the store have the others, and verifying tells of what is known in no unit."""
    assert {(one.property, one.count) for one in objects_by_properties(odd)} == {("mass", 3), ("frob", 2), ("grit", 1)}
    faults = [fault.what for fault in verify(odd)]
    assert faults == ["what is known of its mass is in 'blorbs', which is no unit here"]


def test_values_are_shown_in_their_own_unit(odd: Store, client: TestClient) -> None:
    """What shares the unit is a plot; what is in it beside others by what it was in SI units, or as it was given."""
    page = client.get("/objects/lab/cup").text
    assert "fluff [blorbs]: 3 values by 1 device" in page
    assert "above 9 blorbs" in page
    assert "mass [g]: 3 values by 1 device" in page
    assert "28 g, 2024-05-01" in page
    assert ">above 8 blorbs</a>" in page
    assert "grit [g]: 1 value by 1 device" in page
    assert ">5 blorbs</a>" in page
    assert "2 blorbs" in page


def test_what_is_known_in_such_a_unit_is_in_nobodys_way(odd: Store) -> None:
    """The object is described otherwise, and what is known stays until it is forgotten; nobody can tell it anew."""
    change_thing(odd, CUP, lambda thing: thing.described(maker="Acme"))
    (known,) = find_thing(odd, "lab/cup").known
    assert known.entry == Value("mass", 2.0, unit="blorbs")
    change_thing(odd, CUP, lambda thing: thing.without("mass"))
    assert (find_thing(odd, "lab/cup").ref.maker, find_thing(odd, "lab/cup").known) == ("Acme", ())
    with pytest.raises(StoreError, match="unknown unit 'blorbs'"):
        undo(odd, CUP)


def test_what_cannot_be_compared_is_left_out_and_named(odd: Store, client: TestClient) -> None:
    """The comparison and the benchmark count what they can, and say which unit they cannot."""
    told = "in a unit that is not known here"
    names = ("fluff", "mass", "grit", "frob")
    fluff, mass, grit, frob = (client.get(f"/compare?property={name}").text for name in names)
    assert told in fluff
    assert "blorbs" in fluff.partition(told)[2]
    assert "blorbs" in mass.partition(told)[2]
    # a value without one in SI units is never compared, as where nobody has stated its unit
    assert told not in grit + frob
    for name, count, mean in (("mass", 3, 24.0), ("grit", 1, 6.0)):
        row, *more = client.get(f"/compare/table.csv?property={name}").text.splitlines()[1:]
        assert not more
        assert row.split(",")[3:6] == ["g", str(count), "0"]
        assert float(row.split(",")[6]) == pytest.approx(mean)
    assert client.get("/compare/table.csv?property=fluff").text.count("\n") == 1
    benchmark = client.get("/benchmark").text
    assert "fluff [blorbs]" in benchmark.partition(told)[2]
    assert [one["property"] for one in client.get("/benchmark/errors.json").json()["items"]] == ["frob"]
