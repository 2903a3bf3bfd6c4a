"""What somebody sees of an object, and finds it by, is the same whatever is said of it where they do not see it."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any

import pytest

from palpate.store.changing_seen import change_seen, seen_history
from palpate.store.describing import change_thing
from palpate.store.keeping_episodes import put_episode
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from palpate.store.parts import head_of
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_things import ThingFilter, list_visible_things, visible_thing
from tests.store.made_up import made_episode, squeeze

Edit = Callable[[Thing], Thing]
Step = Callable[[Store, Sequence[ThingRef], int], None]
"""What is done with a store, given what is said where the public does not see it, and the number of the step."""

PUBLIC, CARL, BOB = Viewer(), Viewer("carl", lab=True), Viewer("bob", everything=True)
WORDS = ("Acme", "Bolt", "Cöpper", "cup", 'd"e')
TOLD = ("Mug", "pot \\ pan", "jar")
"""What persons say aloud, and no recording."""


def ref(maker: str | None = None, common_name: str | None = None, *aliases: str) -> ThingRef:
    return ThingRef("lab", "thing", maker=maker, common_name=common_name, aliases=aliases)


def made_ref(random: Random) -> ThingRef:
    maker, common = (random.choice((None, *WORDS)) for _ in range(2))
    return ref(maker, common, *random.sample(WORDS, random.randrange(3)))


def finds(store: Store, viewer: Viewer, word: str) -> bool:
    """By a part of it too, in any case."""
    first = word.split(maxsplit=1)[0]
    (whole, part, small) = (
        bool(list_visible_things(store, viewer, ThingFilter(text=text)).rows)
        for text in (first, first[1:], first.lower())
    )
    assert not whole or part
    if word.isascii():
        assert whole == small
    return whole


def named(store: Store, viewer: Viewer, word: str) -> bool:
    recordings = list_recordings(store, VisibleFilter(thing=word, viewer=viewer)).rows
    episodes = list_episodes(store, thing=word, viewer=viewer).rows
    assert bool(recordings) == bool(episodes)
    return bool(recordings)


def shown(store: Store, viewer: Viewer = PUBLIC) -> list[object]:
    """All that somebody sees of the thing, and finds it by; the two agree, and so do all ways to it."""
    found = visible_thing(store, viewer, "lab", "thing")
    assert found is not None
    assert [one.ref for one in list_visible_things(store, viewer).rows] == [found.ref]
    rows = list_recordings(store, VisibleFilter(viewer=viewer)).rows
    names = {row.common_name for row in rows} | {row.common_name for row in list_episodes(store, viewer=viewer).rows}
    assert names == {found.ref.common_name}
    heads = [head_of(store, viewer, row.id) for row in rows]
    assert all(head is not None and head.thing == found.ref for head in heads)
    called = {found.ref.common_name, *found.ref.aliases}
    assert {word for word in (*WORDS, *TOLD) if named(store, viewer, word)} == called - {None}
    found_by = {word for word in (*WORDS, *TOLD) if finds(store, viewer, word)}
    assert found_by == {*called, found.ref.maker} - {None}
    return [found, seen_history_of(store, viewer)]


def seen_history_of(store: Store, viewer: Viewer) -> list[object]:
    return [(one.who, one.what, one.detail) for one in seen_history(store, viewer, ref())]


def sent(said: ThingRef) -> Step:
    return lambda store, hidden, number: _put(store, squeeze(number, thing=said, visibility="public", owner="eve"))


def sent_hidden(store: Store, hidden: Sequence[ThingRef], number: int) -> None:
    _put(store, squeeze(number, thing=hidden[number], owner="ann"))


def told_hidden(store: Store, hidden: Sequence[ThingRef], number: int) -> None:
    """As what comes with an archive, which nobody hears."""
    said = hidden[number]
    words = {"maker": said.maker, "common_name": said.common_name, "aliases": said.aliases}
    change_thing(store, ref(), lambda thing: thing.described(**words), who="archive copied")


def _put(store: Store, recording: Any) -> None:
    store.put(recording)


def told(edit: Edit) -> Step:
    """By somebody who sees all."""
    return lambda store, hidden, number: _ignore(change_thing(store, ref(), edit, who="bob"))


def changed(edit: Edit) -> Step:
    """By somebody who sees what the public does."""
    return lambda store, hidden, number: _ignore(change_seen(store, CARL, ref(), edit, who="carl"))


def _ignore(_: Thing) -> None:
    return None


def saying(random: Random) -> Edit:
    """What adds something that no recording says."""
    word = random.choice(TOLD)
    return random.choice(
        (
            lambda thing: thing.described(maker=word),
            lambda thing: thing.described(common_name=word),
            lambda thing: thing.described(aliases=tuple(dict.fromkeys((*thing.ref.aliases, word)))),
            lambda thing: thing.described(attributes={**thing.ref.attributes, "colour": word}),
        )
    )


def changing(random: Random) -> Edit:
    """What says or takes away what recordings may say too."""
    word, place = random.choice((None, *WORDS, *TOLD)), random.random()
    aliases = () if word is None else (word,)
    return random.choice(
        (
            lambda thing: thing.described(maker=word),
            lambda thing: thing.described(common_name=word),
            lambda thing: thing.described(aliases=tuple(dict.fromkeys((*thing.ref.aliases, *aliases)))),
            lambda thing: thing.described(aliases=tuple(one for one in thing.ref.aliases if hash(one) % 3 > place)),
            lambda thing: thing.described(attributes={"colour": word}),
        )
    )


def steps_of(random: Random) -> Iterator[Step]:
    """Either persons see what the public does, and change it as they like; or some are not heard, and others add."""
    is_seen = random.random() < 0.5
    kinds: tuple[Callable[[], Step], ...] = (
        lambda: sent(made_ref(random)),
        lambda: sent_hidden,
        (lambda: changed(changing(random))) if is_seen else (lambda: told(saying(random))),
        (lambda: sent_hidden) if is_seen else (lambda: told_hidden),
    )
    for _ in range(random.randrange(2, 7)):
        yield random.choice(kinds)()


def lived(store: Store, steps: Sequence[Step], hidden: Sequence[ThingRef]) -> Store:
    """A store with a thing that all see, and a hidden recording of it."""
    _put(store, squeeze(100, thing=ref(), owner="ann"))
    _put(store, public := squeeze(101, thing=ref(), visibility="public"))
    put_episode(store, made_episode(public, thing=ref(), visibility="public"))
    for number, step in enumerate(steps):
        step(store, hidden, number)
    return store


@pytest.mark.parametrize("seed", range(8))
def test_what_is_hidden_changes_nothing_that_is_seen(tmp_path: Path, seed: int) -> None:
    """Whatever was sent and said, in whichever order."""
    random = Random(seed)
    steps, seen = list(steps_of(random)), list[object]()
    for number in range(3):
        hidden = [made_ref(random) if number else ref() for _ in steps]
        with open_store(tmp_path / f"{number}.sqlite", tmp_path / "blobs", durable=False) as store:
            seen.append(shown(lived(store, steps, hidden)))
    assert seen[1] == seen[0]
    assert seen[2] == seen[0]
