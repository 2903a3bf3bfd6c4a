from collections.abc import Callable
from datetime import timedelta
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sqlalchemy import ColumnElement, select

from palpate.store import schema
from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.errors import DamagedError, StoreError
from palpate.store.filters import Filter, Sort
from palpate.store.legible import reading
from palpate.store.listing import Listed, list_recordings, to_arrow
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from tests.store.made_up import START, squeeze

OTHER = Setup(gripper=Device("gripper", "soft_hand"), camera=Device("camera", "eye"))
MADE = [
    squeeze(
        number,
        action=["squeezing", "weighing", "looking"][number % 3],
        setup=OTHER if number % 2 else squeeze().setup,
        owner=[None, "ann", "bob"][number % 3],
        ground_truth=number % 4 == 0,
        visibility="public" if number % 7 == 1 else "lab",
        notices=("100% Odd_",) if number % 5 == 0 else (),
        recorded_at=START + timedelta(seconds=number // 2),
        entries=[
            (Value("mass", float(number + 1), 1.0, "g"), Value("mass", float(number + 2), 1.0, "g")),
            (Distribution("material", {"wood": 0.2 + 0.06 * number, "metal": 0.8 - 0.06 * number}),),
            (FailedEntry("slipped", "mass"), Value("elasticity", 1.0, unit="kPa")),
        ][number % 3],
    )
    for number in range(12)
]


def labelled(recording: Recording, name: str, label: str) -> bool:
    found = [entry for entry in recording.entries if isinstance(entry, Distribution) and entry.property == name]
    return any(max(entry.probabilities, key=entry.probabilities.__getitem__) == label for entry in found)


Truth = Callable[[Recording], bool]
FILTERS: dict[str, tuple[Filter, Truth]] = {
    "all": (Filter(), lambda r: True),
    "thing": (Filter(thing="object1"), lambda r: r.thing.id == "object1"),
    "dataset": (Filter(dataset="elsewhere"), lambda r: False),
    "action": (Filter(action="weighing"), lambda r: r.action == "weighing"),
    "visibility": (Filter(visibility="public"), lambda r: r.visibility == "public"),
    "owner": (Filter(owner="ann"), lambda r: r.owner == "ann"),
    "property": (Filter(property="mass"), lambda r: any(e.property == "mass" for e in r.entries)),
    "label": (Filter(labels={"material": "wood"}), lambda r: labelled(r, "material", "wood")),
    "device": (Filter(device="eye"), lambda r: r.setup == OTHER),
    "gripper": (Filter(gripper="soft_hand"), lambda r: r.setup == OTHER),
    "setup": (Filter(setup=OTHER.digest), lambda r: r.setup == OTHER),
    "since": (Filter(since=START + timedelta(seconds=2)), lambda r: r.recorded_at >= START + timedelta(seconds=2)),
    "until": (Filter(until=START + timedelta(seconds=2)), lambda r: r.recorded_at < START + timedelta(seconds=2)),
    "truth": (Filter(ground_truth=True), lambda r: r.ground_truth),
    "no truth": (Filter(ground_truth=False), lambda r: not r.ground_truth),
    "text": (Filter(text="100% oDD_"), lambda r: r.notices != ()),
    "text is no pattern": (Filter(text="1%o"), lambda r: False),
    "gripper and property": (
        Filter(gripper="soft_hand", property="mass"),
        lambda r: r.setup == OTHER and any(e.property == "mass" for e in r.entries),
    ),
    "two properties": (
        Filter(property="mass", labels={"material": "wood"}, action="weighing"),
        lambda r: False,
    ),
    "property, action, owner": (
        Filter(property="elasticity", action="looking", owner="bob"),
        lambda r: r.action == "looking",
    ),
}


def all_rows(store: Store, wanted: Filter, sort: Sort, limit: int) -> list[Listed]:
    """All pages one after the other."""
    rows: list[Listed] = []
    cursor = None
    while True:
        page = list_recordings(store, wanted, sort, limit=limit, cursor=cursor)
        rows += page.rows
        if page.cursor is None:
            return rows
        cursor = page.cursor


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("sort", [Sort(), Sort("recorded", False), Sort("uploaded"), Sort("action", False)], ids=str)
def test_filters_give_what_they_say(store: Store, name: str, sort: Sort) -> None:
    """Each filter gives the recordings that it describes, each once, in pages of any size and in any order."""
    store.put_many(MADE)
    wanted, holds = FILTERS[name]
    expected = {recording.id for recording in MADE if holds(recording)}
    for limit in (1, 5, 50):
        found = [row.id for row in all_rows(store, wanted, sort, limit)]
        assert len(found) == len(set(found))
        assert set(found) == expected


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.booleans(), st.sampled_from(["recorded", "action"]))
def test_lists_are_sorted(local: Store, descending: bool, by: str) -> None:
    """Rows come in the order asked for, with what the recordings say."""
    local.put_many(MADE)
    rows = all_rows(local, Filter(), Sort(by, descending), 5)
    keys: list[Any] = [row.action if by == "action" else row.recorded_at for row in rows]
    assert keys == sorted(keys, reverse=descending)
    by_id = {recording.id: recording for recording in MADE}
    assert all(row.entries == by_id[row.id].entries and row.notices == by_id[row.id].notices for row in rows)


@pytest.mark.parametrize("sort", [Sort(by) for by in ("recorded", "uploaded", "action")])
def test_a_damaged_cell_hides_no_other_recording(local: Store, sort: Sort) -> None:
    """It is told with the recording that it is of, and the pages go on behind it."""
    local.put_many(MADE)
    with local.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE recordings SET owner = x'00' WHERE id = 5")
    told: list[str] = []
    listed, cursor = list[Listed](), None
    for _ in range(4):
        page = list_recordings(local, None, sort, limit=3, cursor=cursor, damaged=lambda error: told.append(str(error)))
        listed, cursor = [*listed, *page.rows], page.cursor
    assert {one.id for one in listed} == {one.id for one in MADE if one != MADE[4]}
    assert told == [rf"recording {MADE[4].id}: a cell holds b'\x00', expected str"]
    with pytest.raises(DamagedError, match=str(MADE[4].id)):
        list_recordings(local, None, sort)


def test_pages_hold_while_others_write(local: Store) -> None:
    """A recording that comes in between two pages neither repeats nor hides a row."""
    local.put_many(MADE[:8])
    first = list_recordings(local, limit=4)
    local.put(squeeze(99))
    second = list_recordings(local, limit=4, cursor=first.cursor)
    assert {row.id for row in (*first.rows, *second.rows)} == {recording.id for recording in MADE[:8]}


@pytest.mark.parametrize("cursor", ["", "mug", "W10", "WyJhY3Rpb24iLHRydWUsMSwxXQ"])
def test_foreign_cursors_are_refused(local: Store, cursor: str) -> None:
    """What is no cursor of a list sorted like this is an error in one sentence."""
    with pytest.raises(StoreError, match=r"cursor: .* expected the cursor of its last page"):
        list_recordings(local, cursor=cursor)


def test_bad_filters_are_refused(local: Store) -> None:
    """A sorting that there is not, a time without zone and a digest that is none are errors in one sentence."""
    with pytest.raises(StoreError, match="sort: found 'size'"):
        Sort("size")
    with pytest.raises(StoreError, match=r"since: .* has no time zone"):
        list_recordings(local, Filter(since=START.replace(tzinfo=None)))
    with pytest.raises(StoreError, match="digest: found 'mug'"):
        list_recordings(local, Filter(setup="mug"))


def test_rows_as_arrow(local: Store) -> None:
    """A page is an Arrow table with a row for each recording, empty or not."""
    assert to_arrow(list_recordings(local)).num_rows == 0
    local.put_many(MADE)
    table = to_arrow(list_recordings(local, Filter(thing="object1")))
    assert table.num_rows == 4
    assert set(table.column("thing").to_pylist()) == {"object1"}


def test_common_names_and_aliases_find_objects(local: Store) -> None:
    """An object is found by its name in its dataset, its common name and its aliases."""
    local.put(squeeze(0, thing=ThingRef("made_up", "007", common_name='plastic "mug"', aliases=("Tasse_",))))
    for name in ("007", 'plastic "mug"', "Tasse_"):
        assert len(list_recordings(local, Filter(thing=name)).rows) == 1
    assert not list_recordings(local, Filter(thing="Tass")).rows


UNASKABLE = [
    schema.recordings.c.action == "half of a pair \ud800",
    schema.recordings.c.owner == "a zero \0 byte",
    schema.recordings.c.id == 1 << 64,
]


@pytest.mark.parametrize("condition", UNASKABLE, ids=["half", "zero", "number"])
def test_what_cannot_be_looked_for_is_no_outage(store: Store, condition: ColumnElement[bool]) -> None:
    """Who asks so is told so, as the database is neither away nor damaged; SQLite can look for a zero byte."""
    store.put(squeeze())
    asked = select(schema.recordings.c.id).where(condition)
    if condition is UNASKABLE[1] and store.engine.dialect.name == "sqlite":
        with reading(store.engine) as connection:
            assert connection.scalar(asked) is None
        return
    with (
        pytest.raises(StoreError, match="is none that a database can look for") as told,
        reading(store.engine) as asking,
    ):
        asking.execute(asked)
    assert type(told.value) is StoreError
    assert "sqlite" not in str(told.value)
    assert "postgresql" not in str(told.value)
