"""How many questions are asked: each takes a database time to plan, however little it finds."""

from palpate.store.counting import Counts, counted
from palpate.store.describing import change_thing
from palpate.store.entries import Value
from palpate.store.keeping_episodes import put_episode
from palpate.store.merging import merge_things
from palpate.store.records import Device, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_setups import Choices, seen_choices
from palpate.store.visible_things import list_visible_things, things_by_name, visible_thing
from tests.store.asked import questions
from tests.store.made_up import made_episode, squeeze

PUBLIC, CARL, BOB = Viewer(), Viewer("carl", lab=True), Viewer("bob", everything=True)
A, B, C = (ThingRef("made_up", name) for name in "abc")


def fill(store: Store) -> None:
    """What all see of two objects, and what nobody but its owner does of a third."""
    for number, (thing, visibility) in enumerate(((A, "public"), (B, "public"), (B, "private"), (C, "private"))):
        gripper = Device("gripper", f"hand of {thing.id}")
        store.put(squeeze(number, thing=thing, visibility=visibility, owner="ann", setup=Setup(gripper=gripper)))


def test_what_there_is_is_counted_by_one_question(store: Store) -> None:
    """Recordings, objects, grippers and episodes, of each those that are seen."""
    fill(store)
    put_episode(store, made_episode(number=1, thing=A, visibility="public"))
    put_episode(store, made_episode(number=2, thing=A, owner="ann"))
    with questions(store.engine) as asked:
        found = counted(store, PUBLIC), counted(store, Viewer("ann", lab=True)), counted(store, BOB)
    assert found == (Counts(2, 2, 2, 1), Counts(4, 3, 3, 2), Counts(4, 3, 3, 2))
    assert len(asked) == len(found)


def test_what_recordings_are_found_by_is_one_question(store: Store) -> None:
    """Actions, properties and grippers, of each those of a recording that is seen, known to be true or not."""
    fill(store)
    store.put(squeeze(7, thing=A, action="weighing", ground_truth=True, visibility="public"))
    store.put(squeeze(8, thing=C, action="hiding", ground_truth=True, entries=(Value("secrecy", 1.0),), owner="ann"))
    with questions(store.engine) as asked:
        public, ann, every = (seen_choices(store, viewer) for viewer in (PUBLIC, Viewer("ann"), BOB))
    hands, hand = ("hand of a", "hand of b", "hand of c", "two_finger"), ("hand of a", "hand of b", "two_finger")
    assert public == Choices(("squeezing", "weighing"), ("elasticity",), hand)
    assert ann == every == Choices(("hiding", "squeezing", "weighing"), ("elasticity", "secrecy"), hands)
    assert len(asked) == 3


def listed(store: Store, viewer: Viewer) -> tuple[list[int], int]:
    """How many recordings a list of objects tells of each, and how many questions it asks."""
    with questions(store.engine) as asked:
        found = list_visible_things(store, viewer).rows
    return [one.recordings for one in found], len(asked)


def test_a_list_asks_of_nothing_that_is_not_there(store: Store) -> None:
    """Where nothing is merged nobody asks which of it is seen."""
    fill(store)
    # rows, objects, what is known of them, pictures and what is merged; recordings, or what is seen of all these
    assert listed(store, PUBLIC) == ([1, 1], 8)
    assert listed(store, CARL) == ([1, 1], 8)
    assert listed(store, BOB) == ([1, 2, 1], 6)
    merge_things(store, C, B)
    assert listed(store, PUBLIC) == ([1, 1], 9)
    assert listed(store, BOB) == ([1, 3], 6)


def test_an_object_is_looked_for_once(store: Store) -> None:
    """Whether it is seen is asked once, and not with each of its parts."""
    fill(store)
    change_thing(store, A, lambda thing: thing.described(common_name="cup"), who="ann")
    for find in (
        lambda: visible_thing(store, PUBLIC, "made_up", "a"),
        lambda: things_by_name(store, PUBLIC, [("made_up", "a")])["made_up", "a"],
    ):
        with questions(store.engine) as asked:
            found = find()
        assert found is not None
        assert found.ref.common_name == "cup"
        assert sum("coalesce(things.merged_into, things.id)" in one for one in asked) == 1
    with questions(store.engine) as asked:
        assert visible_thing(store, PUBLIC, "made_up", "c") is None
    assert len(asked) == 1


def test_conditions_of_one_look_are_of_one_moment(store: Store) -> None:
    """Each viewer has conditions of its own, of the moment at which they looked first."""
    first, later = Viewer("ann"), Viewer("ann")
    first.__dict__["now_us"], later.__dict__["now_us"] = 1, 2
    texts = [str(one.things().compile(compile_kwargs={"literal_binds": True})) for one in (first, later)]
    assert texts[0] != texts[1]
    assert texts[0].replace("<= 1", "<= 2") == texts[1]
    assert first.things() is first.things()
