"""Names that nothing in a store has."""

from palpate.store.describing import change_thing
from palpate.store.entries import Distribution
from palpate.store.filters import Filter
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.unknown import unknown_names
from tests.store.made_up import squeeze

MUG = ThingRef("ycb", "025_mug", common_name="mug", aliases=("beaker",))
KNOWN = (
    *(Filter(thing=name) for name in ("025_mug", "mug", "beaker", "ycb/025_mug")),
    Filter(dataset="ycb", action="squeezing", owner="ann", gripper="two_finger", device="two_finger"),
    Filter(property="elasticity", labels={"kind": "mug"}, known={"shape": "round", "material": "ceramic"}),
    Filter(text="nothing has this"),
)
UNKNOWN = {
    "thing": Filter(thing="mugg"),
    "dataset": Filter(dataset="mug"),
    "action": Filter(action="mug"),
    "owner": Filter(owner="mug"),
    "gripper": Filter(gripper="mug"),
    "device": Filter(device="mug"),
    "property": Filter(property="mug"),
}


def filled(store: Store) -> Store:
    entries = (*squeeze().entries, Distribution("kind", {"mug": 0.9, "box": 0.1}))
    store.put(squeeze(1, thing=MUG, owner="ann", entries=entries))
    store.put(squeeze(2, thing=MUG, owner="ann", entries=(Distribution("shape", {"round": 1.0}),), ground_truth=True))
    ceramic = Distribution("material", {"ceramic": 1.0})
    change_thing(store, MUG, lambda thing: thing.knowing(ceramic, "data sheet"))
    return store


def test_what_there_is_is_known(store: Store) -> None:
    """All that a recording, its object and its devices are called, also where no recording has it all."""
    filled(store)
    for wanted in KNOWN:
        assert list(unknown_names(store, wanted)) == []


def test_what_there_is_not_is_told_with_what_there_is(store: Store) -> None:
    """Each name with the field that it stands in and the names there."""
    filled(store)
    for field, wanted in UNKNOWN.items():
        (found,) = unknown_names(store, wanted)
        assert found.field == field
        assert found.name in ("mug", "mugg")
        assert found.known
    assert [one.field for one in unknown_names(store, Filter(dataset="x", action="y"))] == ["dataset", "action"]


def test_of_properties_and_labels_the_first_that_is_unknown_is_told(store: Store) -> None:
    """A label of a property that is not there cannot be there either; what is said of objects has no results."""
    filled(store)
    told = [
        (one.field, one.what, one.name, one.known)
        for wanted in (
            Filter(labels={"kin": "mug"}),
            Filter(labels={"kind": "box"}),
            Filter(labels={"material": "ceramic"}),
            Filter(known={"material": "wood"}),
            Filter(known={"kind": "mug"}),
            Filter(known={"shape": "square"}),
        )
        for one in unknown_names(store, wanted)
    ]
    assert told == [
        ("labels", "property", "kin", ("elasticity", "kind", "shape")),
        ("labels", "label of kind", "box", ("mug",)),
        ("labels", "property", "material", ("elasticity", "kind", "shape")),
        ("known", "known label of material", "wood", ("ceramic",)),
        # measured, and so not known
        ("known", "known property", "kind", ("material", "shape")),
        ("known", "known label of shape", "square", ("round",)),
    ]
