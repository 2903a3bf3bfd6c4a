"""A store knows what is true of objects that are simulated."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from palpate.network.model import KnownObject, TrueValue
from palpate.network.reading import load_network
from palpate.robots.simulated_truth import SOURCE, simulated_thing, tell_truth
from palpate.store.describing import change_thing
from palpate.store.entries import Distribution, Value
from palpate.store.errors import StoreError
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing
from palpate.store.undoing import undo

NETWORK = load_network("household-filled")
TRUTH = {
    "mass": TrueValue(66.0, "measured"),
    "material": TrueValue("soft-plastic", "assumed"),
    "elasticity": TrueValue(55.0, "unknown"),
}
BANANA = KnownObject("banana_ycb", "of plastic", TRUTH, "banana")
THING = simulated_thing("simulated", BANANA)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


def known(store: Store) -> set[tuple[str | None, str]]:
    return {(one.entry.property, one.source) for one in find_thing(store, "banana_ycb").known}


def test_what_is_true_is_known_and_stand_ins_are_not(store: Store) -> None:
    """Measured and assumed values are told with their source, and what the object looks like; telling again is none."""
    tell_truth(store, THING, BANANA, NETWORK, who="ann")
    found = find_thing(store, "simulated/banana_ycb")
    assert {one.entry.property: one.entry for one in found.known} == {
        "mass": Value("mass", 66.0, None, "g"),
        "material": Distribution("material", {"soft-plastic": 1.0}),
    }
    assert {one.source for one in found.known} == {SOURCE}
    assert found.ref.attributes == {"looks_like": "banana"}
    tell_truth(store, THING, BANANA, NETWORK)
    assert find_thing(store, "banana_ycb") == found


def test_what_a_person_took_back_does_not_come_again(store: Store) -> None:
    """Nor does what a person has forgotten; what they say beside it stays."""
    tell_truth(store, THING, BANANA, NETWORK)
    change_thing(store, THING, lambda thing: thing.without("mass").knowing(Value("mass", 70.0, None, "g"), "a scale"))
    tell_truth(store, THING, BANANA, NETWORK)
    assert known(store) == {("mass", "a scale"), ("material", SOURCE)}
    undo(store, THING)
    undo(store, THING)
    tell_truth(store, THING, BANANA, NETWORK)
    assert known(store) == set()


def test_another_object_under_the_same_name_is_refused(store: Store) -> None:
    """Recordings of both would be under one name; nothing is changed."""
    tell_truth(store, THING, BANANA, NETWORK)
    before = find_thing(store, "banana_ycb")
    heavier = replace(BANANA, truth={**TRUTH, "mass": TrueValue(80.0, "measured")})
    with pytest.raises(StoreError, match=r"simulated/banana_ycb: mass .* before is 66 g, and .* has 80 g; expected"):
        tell_truth(store, THING, heavier, NETWORK)
    assert find_thing(store, "banana_ycb") == before


def test_an_object_that_looks_like_itself_says_nothing_of_it() -> None:
    """Only tricks have the attribute."""
    assert simulated_thing("simulated", replace(BANANA, looks_like=None)) == ThingRef("simulated", "banana_ycb")
