"""What is said of an object is known to those who see who says it."""

from dataclasses import replace

import pytest

from palpate.store.describing import change_thing
from palpate.store.keeping_episodes import put_episode
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.parts import head_of
from palpate.store.records import Recording, ThingRef
from palpate.store.store import Store
from palpate.store.undoing import undo
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_things import ThingFilter, list_visible_things, visible_thing
from tests.store.made_up import made_episode, squeeze

BARE = ThingRef("lab", "cup")
# a database knows other small letters than Python
TOLD = ThingRef("lab", "cup", "Straße & Söhne", "ÄPFEL_100%", {"colour": "blue"}, ("Häferl", "mug"))
PUBLIC, ANN = Viewer(), Viewer("ann", lab=True)
WORDS = (TOLD.maker, TOLD.common_name, *TOLD.aliases)


def shown(store: Store, viewer: Viewer) -> ThingRef:
    """The object as one finds it, which is the same by all ways."""
    found = visible_thing(store, viewer, "lab", "cup")
    assert found is not None
    (listed,) = list_visible_things(store, viewer).rows
    assert listed.ref == found.ref
    rows = list_recordings(store, VisibleFilter(viewer=viewer)).rows
    assert {row.common_name for row in rows} == {found.ref.common_name}
    for row in rows:
        head = head_of(store, viewer, row.id)
        assert head is not None
        assert head.thing == found.ref
    assert {row.common_name for row in list_episodes(store, viewer=viewer).rows} <= {found.ref.common_name}
    return found.ref


def finds(store: Store, viewer: Viewer, word: str) -> bool:
    """Whether somebody learns by a search that a word is one of the object's."""
    by_name = list_recordings(store, VisibleFilter(thing=word, viewer=viewer)).rows
    episodes = list_episodes(store, thing=word, viewer=viewer).rows
    return bool(by_name or episodes)


def public(number: int, thing: ThingRef = BARE) -> Recording:
    return squeeze(number, thing=thing, visibility="public")


@pytest.fixture
def mixed(store: Store) -> Store:
    """A cup of which a private recording says more than a public one, whichever came first."""
    store.put(squeeze(1, thing=TOLD, owner="ann"))
    store.put(public(2))
    put_episode(store, made_episode(public(2), thing=BARE, visibility="public"))
    return store


def test_what_a_private_recording_says_others_do_not_know(mixed: Store) -> None:
    """Neither in lists nor on the page nor by guessing; its owner knows all of it, and so do administrators."""
    assert shown(mixed, PUBLIC) == BARE
    assert shown(mixed, ANN) == shown(mixed, Viewer(everything=True)) == TOLD
    for word in WORDS:
        assert word is not None
        assert not finds(mixed, PUBLIC, word)
        assert not list_visible_things(mixed, PUBLIC, ThingFilter(text=word[:3])).rows
    assert finds(mixed, ANN, "Häferl")
    assert finds(mixed, PUBLIC, "lab/cup")
    assert list_visible_things(mixed, ANN, ThingFilter(text="mug")).rows
    assert list_visible_things(mixed, PUBLIC, ThingFilter(text="cup")).rows


def test_what_a_public_recording_says_too_all_know(mixed: Store) -> None:
    """Though the private one has said it first; of attributes no recording keeps what it has said."""
    mixed.put(public(3, replace(TOLD, aliases=("mug",))))
    assert shown(mixed, PUBLIC) == replace(TOLD, attributes={}, aliases=("mug",))
    assert finds(mixed, PUBLIC, "mug")
    assert not finds(mixed, PUBLIC, "Häferl")


def test_what_a_person_says_all_know(mixed: Store) -> None:
    """Until it is taken back; what an archive brings is what recordings say elsewhere."""
    change_thing(mixed, BARE, lambda thing: thing.described(attributes={}, aliases=()), who="archive copied")
    change_thing(mixed, BARE, lambda thing: thing.described(aliases=TOLD.aliases), who="archive copied")
    assert shown(mixed, PUBLIC) == BARE
    change_thing(mixed, BARE, lambda thing: thing.described(attributes={"colour": "red"}, aliases=("pot",)), who="ann")
    assert shown(mixed, PUBLIC) == replace(BARE, attributes={"colour": "red"}, aliases=("pot",))
    assert finds(mixed, PUBLIC, "pot")
    undo(mixed, BARE)
    assert shown(mixed, PUBLIC) == BARE


def test_where_all_is_seen_all_is_known(store: Store) -> None:
    """Also attributes, and what only an exploration says."""
    store.put(public(1, replace(TOLD, attributes={})))
    put_episode(store, made_episode(public(1), thing=TOLD, visibility="public"))
    assert shown(store, PUBLIC) == TOLD
    put_episode(store, made_episode(public(1), number=1, thing=TOLD))
    assert shown(store, PUBLIC) == replace(TOLD, attributes={})


@pytest.mark.parametrize("viewer", [Viewer(everything=True), PUBLIC])
@pytest.mark.parametrize("word", ["éclair", "ÉCLAIR", "ÖKOFORM", "äp", "Ömug"])
def test_words_are_found_in_any_case_of_any_alphabet(store: Store, viewer: Viewer, word: str) -> None:
    """By all that is seen, whoever said it, also by the own name of an object."""
    store.put(squeeze(0, thing=ThingRef("lab", "Éclair", "Ökoform", "Äpfel"), visibility="public"))
    said = ThingRef("lab", "Éclair")
    change_thing(store, said, lambda thing: thing.described(aliases=("ömug",)), who="cy")
    assert len(list_visible_things(store, viewer, ThingFilter(text=word)).rows) == 1
