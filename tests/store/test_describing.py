from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.store.audit import history
from palpate.store.describing import change_thing, fields_of, keep_image
from palpate.store.entries import FailedEntry, Value
from palpate.store.errors import DamagedError, StoreError
from palpate.store.merging import merge_things, split_thing
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing, find_thing
from palpate.store.undoing import undo
from palpate.store.verifying import verify
from tests.store.made_up import attributes, entries, names, shown, squeeze

MUG = ThingRef("made_up", "mug")


@pytest.fixture
def filled(store: Store) -> Store:
    store.put_many([squeeze(0, thing=MUG), squeeze(1, thing=ThingRef("made_up", "box"))])
    return store


def test_each_change_is_noted_with_what_was_there(filled: Store) -> None:
    """The audit says who changed which part, from what to what; what stays as it is, is not noted."""
    change_thing(filled, MUG, lambda thing: thing.described(maker="somebody", attributes={"colour": "red"}), who="ann")
    change_thing(filled, MUG, lambda thing: thing.described(attributes={"colour": "blue"}), who="bob")
    change_thing(filled, MUG, lambda thing: thing, who="eve")
    first, second = history(filled, MUG)
    assert first.detail == [
        {"field": ["maker"], "after": "somebody"},
        {"field": ["attributes", "colour"], "after": "red"},
    ]
    assert second.detail == [{"field": ["attributes", "colour"], "before": "red", "after": "blue"}]
    assert (first.who, second.who, second.what) == ("ann", "bob", "changed")


def test_changes_are_undone_last_first(filled: Store) -> None:
    """Undoing takes back one change after the other, merges among them, and notes who did it."""
    before = find_thing(filled, "mug")
    change_thing(filled, MUG, lambda thing: thing.described(common_name="coffee mug"))
    merge_things(filled, MUG, ThingRef("made_up", "box"))
    change_thing(filled, MUG, lambda thing: thing.knowing(Value("mass", 118.0, unit="g"), "scale"))
    assert [undo(filled, MUG, who="bob").what for _ in range(3)] == ["changed", "merged", "changed"]
    assert find_thing(filled, "mug") == before
    assert {change.undone_by for change in history(filled, MUG)} == {"bob"}
    with pytest.raises(StoreError, match="made_up/mug has no change to take back"):
        undo(filled, MUG)


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(st.data())
def test_any_changes_can_be_undone(local: Store, data: st.DataObject) -> None:
    """After any changes, as many undoings give back what was there, and the store verifies."""
    thing = ThingRef("any", data.draw(shown))
    local.put(squeeze(data.draw(st.integers(0, 10**6)), thing=thing, entries=()))
    states = [fields_of(find_thing(local, f"any/{thing.id}"))]
    for _ in range(data.draw(st.integers(1, 3))):
        edit = data.draw(edits())
        changed = fields_of(change_thing(local, thing, edit))
        if changed != states[-1]:
            states.append(changed)
    while len(states) > 1:
        assert fields_of(find_thing(local, f"any/{thing.id}")) == states.pop()
        undo(local, thing)
    assert fields_of(find_thing(local, f"any/{thing.id}")) == states.pop()
    assert list(verify(local)) == []


@st.composite
def edits(draw: st.DrawFn) -> Any:
    described = {
        "maker": draw(st.none() | shown),
        "common_name": draw(st.none() | shown),
        "attributes": draw(attributes),
        "aliases": tuple(draw(st.lists(shown, max_size=2, unique=True))),
    }
    known = draw(st.lists(st.tuples(entries(), names), max_size=2))

    def edit(thing: Thing) -> Thing:
        changed = thing.described(**described)
        for entry, source in known:
            if not isinstance(entry, FailedEntry):
                changed = changed.knowing(entry, source)
        return changed

    return edit


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda thing: thing.described(id="cup"), "became made_up/cup, expected dataset and name to stay"),
        (lambda thing: thing.described(maker=3), "thing.maker: found 3, expected text"),
        (lambda thing: thing.knowing(Value("mass", float("nan"), unit="g"), "ann"), "known mass.value: found nan"),
        (lambda thing: thing.knowing(Value("elasticity", 1.0, unit="g"), "ann"), "known elasticity.unit"),
        (lambda thing: thing.knowing(Value("mass", 1.0, unit="g"), ""), "known mass.source: is empty"),
        (lambda thing: thing.knowing(FailedEntry("slipped", "mass"), "ann"), "a failed measurement tells nothing"),
    ],
)
def test_what_cannot_be_kept_is_refused(filled: Store, edit: Any, message: str) -> None:
    """The error names the part; nothing is changed and nothing noted."""
    before = find_thing(filled, "mug")
    with pytest.raises(StoreError, match=message):
        change_thing(filled, MUG, edit)
    assert find_thing(filled, "mug") == before
    assert history(filled, MUG) == ()


def test_what_was_completed_since_is_not_undone(filled: Store) -> None:
    """Where a recording has filled in what a change had removed, undoing says so and does nothing."""
    change_thing(filled, MUG, lambda thing: thing.described(maker="somebody"))
    change_thing(filled, MUG, lambda thing: thing.described(maker=None))
    filled.put(squeeze(5, thing=ThingRef("made_up", "mug", maker="another")))
    with pytest.raises(StoreError, match="maker was completed since by a recording"):
        undo(filled, MUG)
    assert find_thing(filled, "mug").ref.maker == "another"


def test_a_damaged_audit_is_told_in_one_sentence(filled: Store) -> None:
    """Neither an undo nor a recording that completes the description goes by what cannot be read."""
    change_thing(filled, MUG, lambda thing: thing.described(maker="somebody"))
    with filled.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE audit SET detail = '[{'")
    for act in (
        lambda: undo(filled, MUG),
        lambda: filled.put(squeeze(5, thing=ThingRef("made_up", "mug", common_name="cup"))),
    ):
        with pytest.raises(DamagedError, match=r"^the audit of object made_up/mug: cannot be read"):
            act()


def test_an_image_can_be_a_file(filled: Store, tmp_path: Path) -> None:
    """A picture is kept from a file, replaces one of its name, and is among what is verified."""
    (tmp_path / "mug.png").write_bytes(b"a picture")
    image = keep_image(filled, "mug.png", "image/png", tmp_path / "mug.png")
    other = keep_image(filled, "mug.png", "image/png", b"a better one")
    change_thing(filled, MUG, lambda thing: thing.showing(image).showing(other))
    assert find_thing(filled, "mug").images == (other,)
    filled.blobs.remove(other.sha256)
    assert [fault.where for fault in verify(filled)] == [f"blob {other.sha256}"]


def test_what_is_known_can_be_forgotten(filled: Store) -> None:
    """One source or all of a property are taken away, and others stay."""
    one, other = Value("mass", 1.0, unit="g"), Value("mass", 2.0, unit="g")
    change_thing(filled, MUG, lambda thing: thing.knowing(one, "a").knowing(other, "b"))
    assert len(change_thing(filled, MUG, lambda thing: thing.without("mass", "a")).known) == 1
    assert change_thing(filled, MUG, lambda thing: thing.without("mass")).known == ()


def test_splitting_notes_who_did_it(filled: Store) -> None:
    """A merge that was split off says by whom."""
    merge_things(filled, MUG, ThingRef("made_up", "box"), who="ann")
    split_thing(filled, MUG, who="bob")
    (change,) = history(filled)
    assert (change.who, change.what, change.undone_by) == ("ann", "merged", "bob")


SAID: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"maker": "Acme"}, ("maker",)),
    ({"common_name": "beaker"}, ("common_name",)),
    ({"aliases": ("the red one",)}, ("aliases", "the red one")),
    ({"attributes": {"colour": "red"}}, ("attributes", "colour")),
]


@pytest.mark.parametrize(("said", "field"), SAID)
def test_what_was_taken_back_does_not_come_again(store: Store, said: dict[str, Any], field: tuple[str, ...]) -> None:
    """A recording completes a description, but not by what a person has taken away, in this process or another."""
    plain, told = ThingRef("made_up", "mug"), ThingRef("made_up", "mug", **said)
    store.put(squeeze(0, thing=plain))
    change_thing(store, plain, lambda thing: thing.described(**said))
    undo(store, plain)
    other = Store(store.engine, store.blobs)
    for number, place in enumerate((store, other, Store(store.engine, store.blobs)), 1):
        place.put(squeeze(number, thing=told))
        assert field not in fields_of(find_thing(store, "made_up/mug"))


@pytest.mark.parametrize(("said", "field"), SAID)
def test_what_a_person_removed_does_not_come_again(store: Store, said: dict[str, Any], field: tuple[str, ...]) -> None:
    """Neither where a recording had said it first, and a person then removed it; told again it is there."""
    plain, told = ThingRef("made_up", "mug"), ThingRef("made_up", "mug", **said)
    store.put(squeeze(0, thing=told))
    emptied: dict[str, Any] = {"maker": None, "common_name": None, "aliases": (), "attributes": {}}
    change_thing(store, plain, lambda thing: thing.described(**emptied))
    other = Store(store.engine, store.blobs)
    other.put(squeeze(1, thing=told))
    assert field not in fields_of(find_thing(store, "made_up/mug"))
    other.put(squeeze(2, thing=ThingRef("made_up", "mug", maker="Brown")))
    change_thing(store, plain, lambda thing: thing.described(**said))
    assert field in fields_of(find_thing(store, "made_up/mug"))
