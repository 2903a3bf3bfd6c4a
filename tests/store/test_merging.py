import pytest

from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.filters import Filter
from palpate.store.listing import list_recordings
from palpate.store.merging import merge_things, split_thing
from palpate.store.overview import contents
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties
from palpate.store.verifying import verify
from tests.store.made_up import squeeze

A, B, C = (ThingRef("made_up", name) for name in "abc")


@pytest.fixture
def filled(store: Store) -> Store:
    things = (A, B, C)
    store.put_many(squeeze(n, thing=things[n], entries=(Value("mass", float(n), unit="g"),)) for n in range(3))
    return store


def found(store: Store, name: str) -> int:
    return len(list_recordings(store, Filter(thing=name)).rows)


def test_merged_objects_count_as_one(filled: Store) -> None:
    """Questions about an object give what was measured of those merged into it; recordings stay as they are."""
    merge_things(filled, A, B, who="ann")
    assert (found(filled, "b"), len(contents(filled).things)) == (2, 2)
    assert {(cell.thing, cell.count) for cell in objects_by_properties(filled)} == {("b", 2), ("c", 1)}
    assert not filled.put(squeeze(0, thing=A, entries=(Value("mass", 0.0, unit="g"),))).new
    assert list(verify(filled)) == []


def test_splitting_undoes_merging(filled: Store) -> None:
    """After a chain of merges, splitting gives back what was there, link by link."""
    merge_things(filled, A, B)
    merge_things(filled, B, C)
    assert (found(filled, "c"), found(filled, "b")) == (3, 1)
    split_thing(filled, B)
    assert (found(filled, "c"), found(filled, "b")) == (1, 2)
    split_thing(filled, A)
    assert [found(filled, name) for name in "abc"] == [1, 1, 1]


def test_splitting_in_another_order(filled: Store) -> None:
    """What was split off by itself stays so when the one it went with is split off."""
    merge_things(filled, A, B)
    merge_things(filled, B, C)
    split_thing(filled, A)
    split_thing(filled, B)
    assert [found(filled, name) for name in "abc"] == [1, 1, 1]


def test_merges_that_make_no_sense_are_refused(filled: Store) -> None:
    """An object that is not there, the same twice, one that is merged already, and splitting what is not merged."""
    with pytest.raises(StoreError, match="thing: made_up d is not in the store"):
        merge_things(filled, ThingRef("made_up", "d"), A)
    with pytest.raises(StoreError, match="into: made_up a is the same object"):
        merge_things(filled, A, A)
    with pytest.raises(StoreError, match="thing: made_up a is not merged"):
        split_thing(filled, A)
    merge_things(filled, A, B)
    with pytest.raises(StoreError, match="into: made_up a is merged into another"):
        merge_things(filled, C, A)
