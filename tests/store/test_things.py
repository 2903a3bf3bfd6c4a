from uuid import uuid4

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.store.describing import add_thing, change_thing, keep_image
from palpate.store.entries import Distribution, Value
from palpate.store.errors import StoreError
from palpate.store.filters import Filter, called
from palpate.store.listing import list_recordings
from palpate.store.merging import merge_things
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing, is_thing, list_things, things_where
from tests.store.made_up import names, shown, squeeze

MUG = ThingRef("ycb", "025_mug", maker="somebody", common_name="mug", attributes={"colour": "red"}, aliases=("cup",))


def test_objects_are_found_by_each_of_their_names(store: Store) -> None:
    """The name in the dataset, the common name, an alias, and dataset with name all find an object."""
    store.put_many([squeeze(0, thing=MUG), squeeze(1, thing=ThingRef("other", "box"))])
    for name in ("025_mug", "mug", "cup", "ycb/025_mug"):
        assert find_thing(store, name).ref == MUG
    assert [(thing.path, thing.recordings) for thing in list_things(store)] == [("other/box", 1), ("ycb/025_mug", 1)]


@pytest.mark.parametrize("alias", ["cup", 'a "cup"', "a,b", "50%", "c_p", "\\", "Häferl", "[]", "null", "1"])
def test_aliases_are_matched_exactly(store: Store, alias: str) -> None:
    """An alias is found as it is written, and neither in another case nor as a part or a pattern of another one."""
    add_thing(store, ThingRef("lab", "one", aliases=("another", alias)))
    assert find_thing(store, alias).path == "lab/one"
    for name in (alias.upper(), alias[:-1], f"{alias}x", "another,cup", 'cup","another', "%", "_", "anothe_", "c%p"):
        if name != alias:
            with pytest.raises(StoreError, match="is not in the store"):
                find_thing(store, name)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(aliases=st.lists(shown, max_size=3), name=names)
def test_any_alias_is_matched_exactly(store: Store, aliases: list[str], name: str) -> None:
    """Whatever names there are, an object is found by those that are its own alone."""
    ref = ThingRef("any", uuid4().hex, aliases=tuple(aliases))
    add_thing(store, ref)
    for asked in (*aliases, name):
        with store.engine.connect() as connection:
            found = [thing.path for thing in things_where(connection, called(asked) & is_thing(ref))]
        assert found == ([f"any/{ref.id}"] if asked in aliases else [])


def test_a_name_of_none_or_of_several_is_refused(store: Store) -> None:
    """The error names what was probably meant, or all that are called so."""
    store.put_many([squeeze(0, thing=ThingRef("a", "mug")), squeeze(1, thing=ThingRef("b", "mug"))])
    with pytest.raises(StoreError, match=r"object 'mgu': is not in the store \(did you mean 'mug'\?\)"):
        find_thing(store, "mgu")
    with pytest.raises(StoreError, match="object 'mug': 2 are called so; choose from 'a/mug', 'b/mug'"):
        find_thing(store, "mug")


def test_merged_objects_of_one_name_are_found_as_one(store: Store) -> None:
    """Of two that were merged it is the one they count as; by its path each is found itself."""
    one, other = ThingRef("a", "mug"), ThingRef("b", "mug")
    store.put_many([squeeze(0, thing=one), squeeze(1, thing=other)])
    merge_things(store, one, other)
    head = find_thing(store, "mug")
    assert (head.path, head.merged, head.recordings) == ("b/mug", (one,), 2)
    assert find_thing(store, "a/mug").merged_into == other


def test_all_that_is_known_of_an_object_comes_back(store: Store) -> None:
    """Known properties with their sources, and images, are read as they were given."""
    assert add_thing(store, MUG)
    assert not add_thing(store, MUG)
    image = keep_image(store, "front.png", "image/png", b"a picture")
    mass, material = Value("mass", 118.0, 1.0, "g"), Distribution("material", {"ceramic": 0.9, "glass": 0.1})
    change_thing(store, MUG, lambda thing: thing.knowing(mass, "scale").knowing(material, "data sheet").showing(image))
    found = find_thing(store, "mug")
    assert [(one.entry, one.source) for one in found.known] == [(mass, "scale"), (material, "data sheet")]
    assert store.blobs.get(found.images[0].sha256) == b"a picture"
    assert found.recordings == 0


def test_recordings_are_found_by_what_is_known_of_their_object(store: Store) -> None:
    """A label known of an object, or of one merged with it, or recorded as ground truth, finds all its recordings."""
    things = [ThingRef("made_up", name) for name in "abcd"]
    store.put_many(squeeze(number, thing=thing) for number, thing in enumerate(things))
    wood = Distribution("material", {"wood": 0.8, "metal": 0.2})
    change_thing(store, things[0], lambda thing: thing.knowing(wood, "ann"))
    merge_things(store, things[0], things[1])
    store.put(squeeze(9, thing=things[2], entries=(wood,), ground_truth=True))
    store.put(squeeze(10, thing=things[3], entries=(wood,)))
    found = {row.thing for row in list_recordings(store, Filter(known={"material": "wood"})).rows}
    assert found == {"a", "b", "c"}
    assert list_recordings(store, Filter(known={"material": "wood"}, action="weighing")).rows == ()
    assert list_recordings(store, Filter(known={"material": "metal"})).rows == ()
