import random
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from palpate.store.audit import MERGED, history
from palpate.store.describing import add_thing, change_thing
from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.filters import Filter
from palpate.store.listing import list_recordings
from palpate.store.merging import merge_things, split_thing
from palpate.store.opening import open_store
from palpate.store.overview import contents
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.summary import objects_by_properties
from palpate.store.things import list_things
from palpate.store.undoing import undo
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


def test_what_was_merged_again_by_itself_stays(filled: Store) -> None:
    """An object that was split off and merged by itself into the head does not go with what it was merged into once."""
    merge_things(filled, A, B)
    merge_things(filled, B, C)
    split_thing(filled, A)
    merge_things(filled, A, C)
    split_thing(filled, B)
    assert [found(filled, name) for name in "abc"] == [1, 1, 2]


def test_merges_that_make_no_sense_are_refused(filled: Store) -> None:
    """An object that is not there, the same twice, one that is merged already, and splitting what is not merged."""
    with pytest.raises(StoreError, match="thing: made_up/d is not in the store"):
        merge_things(filled, ThingRef("made_up", "d"), A)
    with pytest.raises(StoreError, match="into: made_up/a is the same object"):
        merge_things(filled, A, A)
    with pytest.raises(StoreError, match="thing: made_up/a is not merged"):
        split_thing(filled, A)
    merge_things(filled, A, B)
    with pytest.raises(StoreError, match="into: made_up/a is merged into another"):
        merge_things(filled, C, A)


NAMES = st.sampled_from("abcdef")


class MergingMachine(RuleBasedStateMachine):
    """Any sequence of merges, splits, changes and undoings, beside a forest of who was merged into whom."""

    def __init__(self) -> None:
        super().__init__()
        self.opened = ExitStack()
        folder = Path(self.opened.enter_context(TemporaryDirectory()))
        self.store = self.opened.enter_context(open_store(folder / "store.sqlite", durable=False))
        for name in "abcdef":
            add_thing(self.store, ThingRef("any", name))
        self.into: dict[str, str] = {}
        self.maker: dict[str, str] = {}
        # of each object what can be taken back: a merge, or the maker that was there before a change
        self.done: dict[str, list[tuple[str, str | None]]] = defaultdict(list)

    def root(self, name: str) -> str:
        return self.root(self.into[name]) if name in self.into else name

    @rule(one=NAMES, other=NAMES)
    def merge(self, one: str, other: str) -> None:
        refs = ThingRef("any", one), ThingRef("any", other)
        if one == other or one in self.into or other in self.into:
            with pytest.raises(StoreError):
                merge_things(self.store, *refs)
            return
        merge_things(self.store, *refs)
        self.into[one] = other
        self.done[one].append((MERGED, None))

    @rule(one=NAMES)
    def split(self, one: str) -> None:
        if one not in self.into:
            with pytest.raises(StoreError):
                split_thing(self.store, ThingRef("any", one))
            return
        split_thing(self.store, ThingRef("any", one))
        del self.into[one]
        self.done[one].remove((MERGED, None))

    @rule(one=NAMES, maker=st.sampled_from(["x", "y", None]))
    def describe(self, one: str, maker: str | None) -> None:
        change_thing(self.store, ThingRef("any", one), lambda thing: thing.described(maker=maker))
        if maker != self.maker.get(one):
            self.done[one].append(("changed", self.maker.get(one)))
            self.set_maker(one, maker)

    @rule(one=NAMES)
    def take_back(self, one: str) -> None:
        if not self.done[one]:
            with pytest.raises(StoreError, match="no change to take back"):
                undo(self.store, ThingRef("any", one))
            return
        what, maker = self.done[one].pop()
        assert undo(self.store, ThingRef("any", one)).what == what
        if what == MERGED:
            del self.into[one]
        else:
            self.set_maker(one, maker)

    def set_maker(self, one: str, maker: str | None) -> None:
        self.maker.pop(one, None)
        if maker is not None:
            self.maker[one] = maker

    @invariant()
    def counts_as_its_root(self) -> None:
        for thing in list_things(self.store):
            name = thing.ref.id
            assert (thing.merged_into.id if thing.merged_into else name) == self.root(name)
            assert thing.ref.maker == self.maker.get(name)
            below = {other for other in "abcdef" if other != name and self.root(other) == name}
            assert {one.id for one in thing.merged} == below

    def teardown(self) -> None:
        assert list(verify(self.store)) == []
        self.opened.close()


TestAnySequence = MergingMachine.TestCase
TestAnySequence.settings = settings(max_examples=25, stateful_step_count=20, deadline=None)


def test_merging_at_once_agrees_with_what_holds(store: Store) -> None:
    """Whoever merges and splits at the same time, each object counts as the one that the merges that hold lead to."""
    names = "abcde"
    for name in names:
        add_thing(store, ThingRef("any", name))

    def change_at_random(seed: int) -> None:
        rng = random.Random(seed)
        for _ in range(12):
            one, other = (ThingRef("any", name) for name in rng.sample(names, 2))
            with suppress(StoreError):
                merge_things(store, one, other) if rng.random() < 0.6 else split_thing(store, one)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(change_at_random, range(4)))
    holds = {one.thing.id: one.detail["into"][1] for one in history(store) if one.what == MERGED and not one.undone_at}

    def root(name: str) -> str:
        return root(holds[name]) if name in holds else name

    for thing in list_things(store):
        assert (thing.merged_into or thing.ref).id == root(thing.ref.id)
