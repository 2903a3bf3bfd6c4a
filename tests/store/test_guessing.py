"""Nobody learns by a search what is said of an object where they do not see it, whatever they say of it themselves."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from palpate.store.describing import change_thing
from palpate.store.keeping_episodes import put_episode
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.records import Recording, ThingRef
from palpate.store.store import Store
from palpate.store.undoing import undo
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_things import ThingFilter, list_visible_things
from tests.store.made_up import made_episode, squeeze

CUP, JAR = ThingRef("lab", "cup"), ThingRef("lab", "jar")
SECRET = "zqxw"
HIDDEN = (
    replace(CUP, maker=SECRET),
    replace(CUP, common_name=SECRET),
    replace(CUP, aliases=("pot", SECRET)),
    replace(CUP, common_name="pot", maker=SECRET, aliases=(SECRET,)),
)
PUBLIC, EVE, ADMIN = Viewer(), Viewer("eve", lab=True), Viewer("root", lab=True, everything=True)
GUESSES = (*(SECRET[:end] for end in range(1, len(SECRET) + 1)), SECRET[1:3], f'"{SECRET[0]}', "zz", "other")
"""Parts of what is hidden, and words that are no part of it."""


def found(store: Store, viewer: Viewer, *words: str) -> bool:
    """Whether a search for words finds the cup."""
    asked = ThingFilter(text=" ".join(words), dataset="lab", in_none_of=("other",))
    return CUP.id in {one.ref.id for one in list_visible_things(store, viewer, asked).rows}


def named(store: Store, viewer: Viewer, name: str) -> tuple[int, int]:
    """How many recordings and explorations there are of what has a name."""
    recordings = list_recordings(store, VisibleFilter(thing=name, viewer=viewer)).rows
    return len(recordings), len(list_episodes(store, thing=name, viewer=viewer).rows)


def answers(store: Store, viewer: Viewer, guesses: Sequence[str]) -> list[object]:
    """All that searches tell of guesses."""
    return [
        (found(store, viewer, word), found(store, viewer, word, "cup"), named(store, viewer, word)) for word in guesses
    ]


def public(number: int, thing: ThingRef = CUP, **changes: Any) -> Recording:
    return squeeze(number, thing=thing, visibility="public", **changes)


def begun(store: Store, *hidden: ThingRef) -> None:
    """A cup that all see, of which private recordings say more."""
    store.put(public(0))
    put_episode(store, made_episode(public(0), thing=CUP, visibility="public"))
    for number, thing in enumerate(hidden, 1):
        store.put(squeeze(number, thing=thing, owner="ann"))


@pytest.mark.parametrize("hidden", HIDDEN)
@pytest.mark.parametrize("visibility", ["private", "public"])
def test_guesses_in_a_recording_of_ones_own_tell_nothing(local: Store, hidden: ThingRef, visibility: str) -> None:
    """What somebody sends says what it says, and a search finds that, whether it is a part of what is hidden or not."""
    begun(local, hidden)
    sent = replace(CUP, maker="xw zz", common_name="zq", aliases=("z", "zqx", "other"))
    local.put(squeeze(50, thing=sent, owner="eve", visibility=visibility, notices=GUESSES, action=SECRET[:2]))
    eve = {word: found(local, EVE, word) for word in GUESSES}
    said = " ".join((sent.maker or "", sent.common_name or "", *sent.aliases, "lab cup"))
    assert eve == {word: word in said for word in GUESSES}
    assert [word for word in GUESSES if found(local, PUBLIC, word)] == (
        [word for word in GUESSES if word in said] if visibility == "public" else []
    )
    assert found(local, ADMIN, SECRET)


@pytest.mark.parametrize("hidden", HIDDEN)
def test_a_name_is_guessed_by_no_other_word(local: Store, hidden: ThingRef) -> None:
    """A recording has notices, an action, a maker: whole words of them are no names, also where they are by chance."""
    begun(local, hidden)
    local.put(squeeze(50, thing=replace(CUP, maker=SECRET), owner="eve", notices=GUESSES, action=SECRET))
    assert [named(local, EVE, word) for word in GUESSES] == [(0, 0)] * len(GUESSES)
    local.put(squeeze(51, thing=replace(CUP, aliases=GUESSES), owner="eve"))
    assert [named(local, EVE, word) for word in GUESSES] == [(3, 1)] * len(GUESSES)
    assert [named(local, PUBLIC, word) for word in GUESSES] == [(0, 0)] * len(GUESSES)


def test_answers_are_those_of_a_store_without_what_is_hidden(store: Store, local: Store) -> None:
    """Of every guess, by whoever does not see it, after recordings and words of persons that they see."""
    said = {"maker": "other", "aliases": ("zq other", 'of "zz"')}
    change = {"before": "zqx", "after": "zz"}

    def lived(place: Store, *hidden: ThingRef) -> list[object]:
        begun(place, *hidden)
        place.put(squeeze(50, thing=replace(JAR, common_name=SECRET), owner="eve"))
        change_thing(place, CUP, lambda thing: thing.described(attributes=change, **said), who="bob")
        return [answers(place, viewer, GUESSES) for viewer in (PUBLIC, EVE)]

    assert lived(store, replace(CUP, common_name=SECRET)) == lived(local)
    assert found(store, ADMIN, SECRET)


def test_what_a_person_said_is_found_by_what_holds_of_it(store: Store) -> None:
    """Not by what was there before, by keys, or by fields that are no names; nor once it was taken back."""
    begun(store, replace(CUP, common_name="first zq"))
    assert not found(store, PUBLIC, "zq")
    words = {"common_name": 'Häferl "zz"', "maker": "A\\B/C", "aliases": ("x'y", "mug")}
    change_thing(store, CUP, lambda thing: thing.described(**words, attributes={"zqx": "other"}), who="bob")
    asked = ("häferl", '"zz"', "a\\b", "c", "y", "MUG", "field", "after", "common_name", "first", "zqx", "other", ",")
    assert [word for word in asked if found(store, PUBLIC, word)] == ["häferl", '"zz"', "a\\b", "c", "y", "MUG"]
    assert [named(store, PUBLIC, name) for name in ('Häferl "zz"', "x'y", "mug")] == [(1, 1)] * 3
    assert [named(store, PUBLIC, name) for name in ("A\\B/C", "other", "common_name", "first zq")] == [(0, 0)] * 4
    change_thing(store, CUP, lambda thing: thing.described(aliases=("x'y",)), who="bob")
    assert (found(store, PUBLIC, "mug"), named(store, PUBLIC, "mug")) == (False, (0, 0))
    undo(store, CUP)
    assert (found(store, PUBLIC, "mug"), named(store, PUBLIC, "mug")) == (True, (1, 1))


def test_where_all_is_seen_each_word_finds_it(store: Store) -> None:
    """Also what only an exploration says; and where not all is seen, what one recording that is seen says."""
    store.put(public(0))
    told = replace(CUP, maker="Acme", common_name="Big Mug", aliases=("pot",))
    put_episode(store, made_episode(public(0), thing=told, visibility="public"))
    assert found(store, PUBLIC, "big", "acme", "cup", "lab")
    assert named(store, PUBLIC, "Big Mug") == named(store, PUBLIC, "pot") == (1, 1)
    store.put(squeeze(1, thing=CUP, owner="ann"))
    assert not found(store, PUBLIC, "acme")
    assert named(store, PUBLIC, "pot") == (0, 0)
    store.put(public(2, told))
    assert found(store, PUBLIC, "big", "acme", "cup", "lab")
    assert named(store, PUBLIC, "Big Mug") == named(store, PUBLIC, "pot") == (2, 1)
    assert not found(store, PUBLIC, "squeezing"), "an action is no word of an object"
