"""What an object is known to be is found by who has heard it, and by nobody who only writes what looks like it."""

import pytest

from palpate.store.content import entry_plain
from palpate.store.describing import change_thing
from palpate.store.entries import Distribution
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.viewing import Viewer
from palpate.store.visible_things import ThingFilter, list_visible_things
from tests.store.made_up import squeeze

CUP = ThingRef("lab", "cup")
LABELS = ("wood", "steel", "glass")


def known_as(store: Store, label: str, viewer: Viewer | None = None) -> int:
    """How many objects somebody finds that are known to be of a material."""
    return len(list_visible_things(store, viewer or Viewer(), ThingFilter(known=[("material", label)])).rows)


def wooden(thing: Thing) -> Thing:
    """The same, of which is said that it is of wood."""
    return thing.knowing(Distribution("material", {"wood": 1.0}), "ann")


@pytest.mark.parametrize("nested", [True, False])
def test_who_writes_what_looks_like_it_learns_nothing(store: Store, nested: bool) -> None:
    """A guess within an attribute is no statement of what is known, whatever it holds."""
    store.put(squeeze(0, thing=CUP, owner="ann", visibility="private"), uploader="ann")
    change_thing(store, CUP, wooden, who="ann")
    store.put(squeeze(1, thing=CUP, owner="eve", visibility="public"), uploader="eve")
    guesses = [entry_plain(Distribution("material", {label: 1.0})) for label in LABELS]
    lies = [{"after": one, "field": ["known", "material", "ann"]} for one in guesses] if nested else guesses
    change_thing(store, CUP, lambda thing: thing.described(attributes={"x": lies}), who="eve")
    assert [known_as(store, label) for label in LABELS] == [0, 0, 0]
    assert known_as(store, "wood", Viewer(everything=True)) == 1


def test_who_has_heard_it_finds_it(store: Store) -> None:
    """Said where all was seen, also in place of something else, and among other things."""
    store.put(squeeze(0, thing=CUP, owner="ann", visibility="public"), uploader="ann")
    change_thing(store, CUP, lambda thing: thing.knowing(Distribution("material", {"steel": 1.0}), "ann"), who="ann")
    change_thing(store, CUP, lambda thing: wooden(thing).described(attributes={"x": {"a": [1, None]}}), who="ann")
    store.put(squeeze(1, thing=CUP, owner="bob", visibility="private"), uploader="bob")
    assert [known_as(store, label) for label in LABELS] == [1, 0, 0]
