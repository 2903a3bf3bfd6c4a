"""Pages that compare: few questions to the database however many properties there are, and numbers of any size."""

from datetime import UTC, datetime, timedelta

from fastapi.testclient import TestClient
from sqlalchemy import event

from palpate.server.benchmark import agreements, agreements_with_truth
from palpate.store.entries import Value
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer

T0 = datetime(2024, 5, 1, tzinfo=UTC)
HAND = Setup(gripper=Device("gripper", "hand"))


def measured(number: int, *entries: Value, truth: bool = False) -> Recording:
    return Recording(
        T0 + timedelta(seconds=number),
        "weighing",
        ThingRef("lab", "cup"),
        setup=HAND,
        entries=entries,
        ground_truth=truth,
        visibility="public",
    )


def statements(client: TestClient, store: Store, address: str) -> int:
    """How many questions a page asks."""
    asked = list[str]()

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        asked.append(statement)

    event.listen(store.engine, "before_cursor_execute", note)
    try:
        assert client.get(address).status_code == 200
    finally:
        event.remove(store.engine, "before_cursor_execute", note)
    return len(asked)


def test_more_properties_are_no_more_questions(client: TestClient, store: Store) -> None:
    """With thirty properties the benchmark and a device's page ask as often as with one, and tell of each."""
    store.put(measured(0, Value("mass", 3.0, unit="g")))
    store.put(measured(1, Value("mass", 1.0, unit="g"), truth=True))
    (device,) = client.get("/api/v1/devices").json()["items"]
    pages = ("/benchmark", f"/devices/{device['digest']}")
    before = [statements(client, store, page) for page in pages]
    names = [f"p{number:02}" for number in range(30)]
    store.put(measured(2, *(Value(name, 5.0, unit="g") for name in names)))
    store.put(measured(3, *(Value(name, 2.0, unit="g") for name in names), truth=True))
    store.put(measured(4, Value("untold", 2.0, unit="g")))
    assert [statements(client, store, page) for page in pages] == before
    found = agreements_with_truth(store, Viewer())
    assert [one.property for one in found] == ["mass", *names]
    assert [one.devices[0].bias for one in found] == [2.0] + [3.0] * 30
    assert found[1] == agreements(store, Viewer(), "p00")


def test_numbers_that_no_measurement_gives_break_no_page(client: TestClient, store: Store) -> None:
    """What was kept before such were refused is left out, and what is beside it is there."""
    huge = [
        measured(number, Value("volume", value, unit="m^3")) for number, value in enumerate((1e200, -1e200, 1.7e308))
    ]
    huge += [measured(3 + place, Value("mass", 1.7e308, unit="g"), truth=place > 1) for place in range(3)]
    store.put_checked(huge)
    store.put(measured(10, Value("volume", 3.0, unit="m^3"), Value("mass", 3.0, unit="g")))
    store.put(measured(11, Value("volume", 1.0, unit="m^3"), Value("mass", 1.0, unit="g"), truth=True))
    for address in ("/", "/recordings", "/objects/lab/cup", "/benchmark", "/benchmark/errors.csv"):
        assert client.get(address).status_code == 200, address
    for name in ("mass", "volume"):
        assert client.get(f"/compare?property={name}").status_code == 200
        assert "inf" not in client.get(f"/compare/table.csv?property={name}").text
    told = client.get("/benchmark/errors.json").json()["items"]
    assert [(one["property"], one["bias"], one["values"]) for one in told] == [("mass", 2.0, 1), ("volume", 2.0, 1)]
