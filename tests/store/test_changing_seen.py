"""Who changes an object, or takes a change back, does so by what they see of it, and learns nothing of the rest."""

from dataclasses import replace
from typing import Any

import pytest

from palpate.store.audit import history
from palpate.store.changing_seen import change_seen, seen_history, undo_seen
from palpate.store.describing import change_thing, fields_of
from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.merging import merge_things, split_thing
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing, find_thing
from palpate.store.viewing import Viewer
from palpate.store.visible_things import visible_thing
from tests.store.made_up import squeeze

CUP, PLAN = ThingRef("lab", "cup"), ThingRef("secret", "plan")
ANN, CARL, EVERYBODY = Viewer("ann", lab=True), Viewer("carl", lab=True), Viewer(everything=True)
MASS = Value("mass", 118.0, unit="g")


@pytest.fixture
def mixed(store: Store) -> Store:
    """A cup with a recording that only ann sees, and a public one that came after her words."""
    store.put(squeeze(1, thing=CUP, owner="ann"))
    return store


def described(store: Store, who: str, **words: Any) -> None:
    change_thing(store, CUP, lambda thing: thing.described(**words), who=who)


def opened(store: Store) -> None:
    """What is said from now on all hear; carl sees the cup and nothing that was said of it before."""
    store.put(squeeze(2, thing=CUP, visibility="public"))


def seen(store: Store, viewer: Viewer = CARL) -> dict[tuple[str, ...], Any]:
    found = visible_thing(store, viewer, CUP.dataset, CUP.id)
    assert found is not None
    return dict(fields_of(found))


HIDDEN: list[tuple[Any, Any, Any]] = [
    ({"maker": "Acme"}, {"maker": "Acme"}, {"maker": "Brown"}),
    ({"common_name": "beaker"}, {"common_name": "beaker"}, {"common_name": "mug"}),
    ({"attributes": {"colour": "red"}}, {"attributes": {"colour": "red"}}, {"attributes": {"colour": "blue"}}),
]


@pytest.mark.parametrize(("said", "same", "other"), HIDDEN)
def test_what_somebody_has_said_is_changed_by_who_sees_it(mixed: Store, said: Any, same: Any, other: Any) -> None:
    """Who does not is told so in one sentence, the same whether they say the same or something else."""
    described(mixed, "ann", **said)
    opened(mixed)
    before, told = find_thing(mixed, "lab/cup"), set[str]()
    for words in (same, other):
        with pytest.raises(StoreError) as refused:
            change_seen(mixed, CARL, CUP, lambda thing, words=words: thing.described(**words), who="carl")  # type: ignore[misc]
        told.add(str(refused.value))
    (sentence,) = told
    assert "somebody has said it where you do not see it, expected a field that you see" in sentence
    assert not any(value in sentence for value in ("Acme", "beaker", "red", "Brown", "mug", "blue"))
    assert (find_thing(mixed, "lab/cup"), len(history(mixed, CUP))) == (before, 1)
    for viewer in (ANN, EVERYBODY):
        change_seen(mixed, viewer, CUP, lambda thing: thing.described(**other), who=viewer.name)
        assert seen(mixed, viewer) == fields_of(Thing(replace(CUP, **other)))
        undo_seen(mixed, viewer, CUP)


def test_a_source_of_somebody_else_is_left_alone(mixed: Store) -> None:
    """What it says of another property, and what other sources say of this one, is told as ever."""
    change_thing(mixed, CUP, lambda thing: thing.knowing(MASS, "scale"), who="ann")
    opened(mixed)
    with pytest.raises(StoreError, match=r"object lab/cup: known\.mass\.scale: somebody has said it where"):
        change_seen(mixed, CARL, CUP, lambda thing: thing.knowing(replace(MASS, value=1.0), "scale"), who="carl")
    change_seen(mixed, CARL, CUP, lambda thing: thing.knowing(replace(MASS, value=1.0), "my scale"), who="carl")
    assert [one.source for one in find_thing(mixed, "lab/cup").known] == ["my scale", "scale"]
    assert set(seen(mixed)) == {("known", "mass", "my scale")}


@pytest.mark.parametrize("guess", [{"maker": "Acme"}, {"common_name": "cup"}, {"aliases": ("pot",)}])
def test_what_a_recording_says_blocks_nobody_and_is_not_guessed(store: Store, guess: Any) -> None:
    """A change shows alike whether a hidden recording says the same or not, and taking it back gives that back."""
    store.put(squeeze(1, thing=replace(CUP, maker="Acme", common_name="cup", aliases=("pot",)), owner="ann"))
    opened(store)
    whole = find_thing(store, "lab/cup")
    for words in (guess, {name: "other" if isinstance(one, str) else ("other",) for name, one in guess.items()}):
        change_seen(store, CARL, CUP, lambda thing, words=words: thing.described(**words), who="carl")  # type: ignore[misc]
        assert seen(store) == fields_of(Thing(replace(CUP, **words)))
        (line,) = seen_history(store, CARL, CUP)[-1:]
        assert [set(part) for part in line.detail] == [{"field", "after"}]
        undo_seen(store, CARL, CUP, who="carl")
        assert (seen(store), find_thing(store, "lab/cup").ref) == ({}, whole.ref)


def test_undo_takes_back_what_is_seen(mixed: Store) -> None:
    """The last change that one sees, though others came later; and none where one sees none."""
    described(mixed, "ann", maker="Acme")
    opened(mixed)
    with pytest.raises(StoreError, match="lab/cup has no change to take back"):
        undo_seen(mixed, CARL, CUP)
    described(mixed, "carl", common_name="mug")
    described(mixed, "archive copied", attributes={"colour": "red"})
    taken = undo_seen(mixed, CARL, CUP, who="carl")
    assert (taken.who, taken.undone_by) == ("carl", "carl")
    assert find_thing(mixed, "lab/cup").ref == replace(CUP, maker="Acme", attributes={"colour": "red"})
    assert undo_seen(mixed, EVERYBODY, CUP).who == "archive copied"


def test_undo_says_where_it_was_changed_unseen(mixed: Store) -> None:
    """Without what it says by now."""
    opened(mixed)
    described(mixed, "carl", maker="mine")
    described(mixed, "archive copied", maker="Acme")
    with pytest.raises(StoreError, match="maker was completed since by a recording, or changed") as refused:
        undo_seen(mixed, CARL, CUP)
    assert "Acme" not in str(refused.value)


def test_merges_name_what_is_seen(mixed: Store) -> None:
    """A merge into an object that is hidden stands in no history, and others do not undo it; while it holds it does."""
    opened(mixed)
    mixed.put(squeeze(3, thing=PLAN, owner="ann"))
    merge_things(mixed, CUP, PLAN, who="root")
    assert [one.what for one in seen_history(mixed, CARL, CUP)] == ["merged"]
    split_thing(mixed, CUP, who="root")
    assert seen_history(mixed, CARL, CUP) == ()
    assert [one.what for one in seen_history(mixed, ANN, CUP)] == ["merged"]
    mixed.put(squeeze(4, thing=PLAN, visibility="public"))
    assert [one.detail for one in seen_history(mixed, CARL, CUP)] == [{"into": ["secret", "plan"]}]
    merge_things(mixed, CUP, PLAN, who="root")
    assert undo_seen(mixed, CARL, CUP).what == "merged"


def opposed(store: Store) -> None:
    """Of the cup a hidden recording says something else than one that all see."""
    store.put(squeeze(1, thing=replace(CUP, maker="Acme", common_name="beaker"), owner="ann"))
    store.put(squeeze(2, thing=replace(CUP, maker="Foo", common_name="mug", aliases=("pot",)), visibility="public"))


def test_what_is_left_alone_stays_as_it_is(store: Store) -> None:
    """Though something else is shown of it to who changes a field beside it."""
    opposed(store)
    whole = find_thing(store, "lab/cup").ref
    change_seen(store, CARL, CUP, lambda thing: thing.described(attributes={"colour": "red"}), who="carl")
    assert find_thing(store, "lab/cup").ref == replace(whole, attributes={"colour": "red"})
    expected = replace(CUP, maker="Foo", common_name="mug", attributes={"colour": "red"}, aliases=("pot",))
    assert seen(store) == fields_of(Thing(expected))


def test_a_common_name_that_is_shown_is_changed(store: Store) -> None:
    """For all, where no person has said the one that is hidden, and back again."""
    opposed(store)
    before, whole = seen(store), find_thing(store, "lab/cup").ref
    change_seen(store, CARL, CUP, lambda thing: thing.described(common_name="jug"), who="carl")
    assert seen(store) == {**before, ("common_name",): "jug"}
    assert find_thing(store, "lab/cup").ref == replace(whole, common_name="jug")
    undo_seen(store, CARL, CUP)
    assert (seen(store), find_thing(store, "lab/cup").ref) == (before, whole)


def test_what_is_taken_away_of_what_is_shown_leaves_what_is_hidden(store: Store) -> None:
    """No recording says it again, and it shows again once that is taken back."""
    opposed(store)
    before, whole = seen(store), find_thing(store, "lab/cup").ref
    bare = {"maker": None, "common_name": None, "aliases": ()}
    change_seen(store, CARL, CUP, lambda thing: thing.described(**bare), who="carl")
    store.put(squeeze(3, thing=replace(CUP, maker="Foo", aliases=("pot",)), visibility="public"))
    assert seen(store) == {}
    assert find_thing(store, "lab/cup").ref == replace(whole, aliases=("mug",))
    undo_seen(store, CARL, CUP)
    assert (seen(store), find_thing(store, "lab/cup").ref) == (before, replace(whole, aliases=("mug", "pot")))


def test_what_a_person_has_said_where_it_is_not_seen_is_not_replaced(store: Store) -> None:
    """Though something else is shown in its place."""
    store.put(squeeze(1, thing=CUP, owner="ann"))
    described(store, "ann", maker="Acme")
    store.put(squeeze(2, thing=replace(CUP, maker="Foo"), visibility="public"))
    assert seen(store) == {("maker",): "Foo"}
    with pytest.raises(StoreError, match="maker: somebody has said it where you do not see it"):
        change_seen(store, CARL, CUP, lambda thing: thing.described(maker="Bar"), who="carl")
