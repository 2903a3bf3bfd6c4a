"""The unit that decides the dimension of a property, and taking it back."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select

from palpate.store import schema
from palpate.store.archive import export_archive
from palpate.store.describing import change_thing
from palpate.store.entries import Bound, Entry, Interval, Value
from palpate.store.entries_table import entries_table
from palpate.store.errors import StoreError
from palpate.store.filters import Filter
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.own_formats import Archives
from palpate.store.measured import measured_of
from palpate.store.opening import open_store
from palpate.store.records import Recording, ThingRef
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties
from palpate.store.things import find_thing
from palpate.store.undoing import undo
from palpate.store.units import PropertyUnit, admit_units, change_unit, list_units, units_of
from palpate.store.verifying import repair, verify
from tests.store.made_up import squeeze

MUG = ThingRef("made_up", "mug")


def fluff(number: int, unit: str | None, *others: Entry) -> Recording:
    return squeeze(number, thing=MUG, entries=(Value("fluff", 10.0 * number, 1.0, unit), *others))


@pytest.fixture
def spoilt(store: Store) -> Store:
    """Two wrong ones came first: what is right is refused."""
    store.put(fluff(1, "g", Interval("fluff", 1.0, 2.0, "g"), Bound("fluff", above=1.0, unit="kg")))
    store.put(fluff(2, "kg"))
    with pytest.raises(StoreError, match=r"unit 'kPa' is .*; expected the dimension that fluff has"):
        store.put(fluff(3, "kPa"))
    return store


@pytest.fixture
def other(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "other.sqlite", durable=False) as found:
        yield found


def means(store: Store) -> list[Any]:
    return [(cell.mean, cell.count, cell.unit) for cell in objects_by_properties(store)]


def test_a_wrong_first_unit_is_taken_back(spoilt: Store) -> None:
    """Afterwards what is right is taken and counts; what is wrong stays as it was given, and does not; all verifies."""
    wrong = spoilt.get(fluff(2, "kg").digest)
    assert change_unit(spoilt, "fluff", "kPa", wrong=True, who="ann") == PropertyUnit("fluff", "kPa", 0, 4)
    assert means(spoilt) == []
    spoilt.put(fluff(3, "kPa"))
    spoilt.put(fluff(4, "MPa"))
    with pytest.raises(StoreError, match="unit 'g' is mass"):
        spoilt.put(fluff(5, "g"))
    assert means(spoilt) == [(pytest.approx((30 + 40_000) / 2), 2, "kPa")]
    assert list_units(spoilt) == (PropertyUnit("fluff", "kPa", 2, 4),)
    (measured,) = measured_of(spoilt, MUG)
    assert (measured.results, measured.unit) == (6, "kPa")
    assert measured.mean == pytest.approx(20_015.0)
    assert spoilt.get(wrong.digest) == wrong
    assert list(verify(spoilt)) == []


def test_a_store_that_is_open_elsewhere_follows(spoilt: Store) -> None:
    """A process that has put units before does not go by what it remembers."""
    other = Store(spoilt.engine, spoilt.blobs)
    other.put(fluff(6, "g"))
    change_unit(spoilt, "fluff", "kPa", wrong=True)
    with pytest.raises(StoreError, match="unit 'g' is mass"):
        other.put(fluff(7, "g"))
    assert other.put(fluff(8, "kPa")).new


def test_changed_back_all_is_as_before(spoilt: Store) -> None:
    """Nothing is lost: the other way round the first ones count again, to the last bit; each change is in the audit."""
    entries = schema.entries.c
    asked = select(entries.recording_id, entries.position, entries.value_si, entries.sd_si).order_by(*entries)
    with spoilt.engine.connect() as connection:
        before = connection.execute(asked).all()
    change_unit(spoilt, "fluff", "kPa", wrong=True, who="ann")
    change_unit(spoilt, "fluff", "g", who="bob")
    with spoilt.engine.connect() as connection:
        assert connection.execute(asked).all() == before
        noted = connection.execute(select(schema.audit).where(schema.audit.c.what == "unit")).mappings().all()
    assert [one["who"] for one in noted] == ["ann", "bob"]
    assert json.loads(noted[0]["detail"]) == {"property": "fluff", "before": "g", "after": "kPa", "results": 4}
    assert list(verify(spoilt)) == []


def test_results_must_be_said_to_be_wrong(spoilt: Store) -> None:
    """Without that, nothing is changed; a unit of the same dimension needs no saying, and what is unused neither."""
    with pytest.raises(StoreError, match="4 of its results are in a unit of another dimension than 'kPa'"):
        change_unit(spoilt, "fluff", "kPa")
    assert change_unit(spoilt, "fluff", "kg") == PropertyUnit("fluff", "kg", 4, 0)
    assert means(spoilt) == [(pytest.approx((0.01 + 20) / 2), 2, "kg")]
    admit_units(spoilt, {"crispness": "N"})
    assert change_unit(spoilt, "crispness", "kPa").unit == "kPa"


@pytest.mark.parametrize(
    ("name", "unit", "message"),
    [
        ("fluf", "kPa", "property: 'fluf' has no unit here .did you mean 'fluff'"),
        ("fluff", "no such", "unit: unknown unit 'no such'"),
        ("mass", "kPa", "unit: unit 'kPa' is .*; expected mass, as 'kg'"),
    ],
)
def test_what_cannot_be_is_refused(spoilt: Store, name: str, unit: str, message: str) -> None:
    """A property that is not there, a unit that is none, and one that everybody knows to be wrong."""
    with pytest.raises(StoreError, match=message):
        change_unit(spoilt, name, unit, wrong=True)
    assert units_of(spoilt) == {"fluff": "g"}


def test_what_is_known_of_objects_is_told_anew_first(spoilt: Store) -> None:
    """Known properties are no results: the object whose is in the way is named."""
    change_thing(spoilt, MUG, lambda thing: thing.knowing(Value("fluff", 1.0, unit="g"), "ann"))
    with pytest.raises(StoreError, match="object made_up/mug: what is known of its fluff is in 'g'"):
        change_unit(spoilt, "fluff", "kPa", wrong=True)
    change_thing(spoilt, MUG, lambda thing: thing.without("fluff"))
    change_unit(spoilt, "fluff", "kPa", wrong=True)


def test_an_undo_brings_no_unit_back_that_was_taken_back(spoilt: Store) -> None:
    """What was known in it, and forgotten so that it could be taken back, is to be told anew."""
    change_thing(spoilt, MUG, lambda thing: thing.knowing(Value("fluff", 1.0, unit="g"), "a person"))
    change_thing(spoilt, MUG, lambda thing: thing.without("fluff"))
    change_unit(spoilt, "fluff", "kPa", wrong=True)
    with pytest.raises(StoreError, match=r"made_up mug: known fluff.unit: unit 'g' is mass; .*: tell it anew"):
        undo(spoilt, MUG)
    assert find_thing(spoilt, "mug").known == ()
    change_unit(spoilt, "fluff", "kg", wrong=True)
    undo(spoilt, MUG)
    assert len(find_thing(spoilt, "mug").known) == 1


def test_rows_are_mended_as_they_count(spoilt: Store) -> None:
    """A repair makes the rows of a wrong result again as they were, without a value in SI units."""
    change_unit(spoilt, "fluff", "kPa", wrong=True)
    with spoilt.engine.begin() as connection:
        connection.execute(schema.entries.update().values(value_si=1.0))
    assert len(repair(spoilt)) == 2
    assert list(verify(spoilt)) == []
    assert means(spoilt) == []


def test_tables_leave_out_what_does_not_count(spoilt: Store) -> None:
    """In the table of results a wrong one has its value and unit, and none in SI units."""
    change_unit(spoilt, "fluff", "kPa", wrong=True)
    spoilt.put(fluff(3, "kPa"))
    rows = {row["value"]: row for row in entries_table(spoilt, Filter()).to_pylist() if row["kind"] == "value"}
    assert (rows[20.0]["unit"], rows[20.0]["value_si"], rows[20.0]["sd_si"]) == ("kg", None, None)
    assert math.isclose(rows[30.0]["value_si"], 30_000.0)


def test_an_archive_says_which_unit_decides(spoilt: Store, other: Store, tmp_path: Path) -> None:
    """Restored in a new store, all are there, and the wrong ones, which come first, neither decide nor count."""
    change_unit(spoilt, "fluff", "kPa", wrong=True)
    spoilt.put(fluff(3, "kPa"))
    export_archive(spoilt, tmp_path / "archive")
    outcomes = list(import_paths(other, [tmp_path / "archive"], [Archives()]))
    assert [one.fate for one in outcomes] == [Fate.NEW] * 3
    assert list_units(other) == (PropertyUnit("fluff", "kPa", 1, 4),)
    assert means(other) == means(spoilt)
    assert list(verify(other)) == []
    with pytest.raises(StoreError, match="unit 'g' is mass"):
        other.put(fluff(9, "g"))


def test_an_archive_with_a_wrong_unit_is_refused(spoilt: Store, other: Store, tmp_path: Path) -> None:
    """A manifest that somebody has changed is told, and nothing is taken."""
    export_archive(spoilt, tmp_path / "archive")
    manifest = tmp_path / "archive" / "manifest.json"
    manifest.write_text(manifest.read_text().replace('"fluff":"g"', '"fluff":"no such"'))
    (outcome,) = import_paths(other, [tmp_path / "archive"], [Archives()])
    assert outcome.fate is Fate.REFUSED
    assert "unknown unit 'no such'" in str(outcome.reason)
    assert units_of(other) == {}
