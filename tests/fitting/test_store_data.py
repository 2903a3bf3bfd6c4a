"""Known properties and readings from a store."""

import json
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import insert, select

from palpate.fitting.data import Specimen
from palpate.fitting.errors import FittingError
from palpate.fitting.known import known_properties
from palpate.fitting.store_data import read_store
from palpate.network.model import Network
from palpate.outcomes import Above, Below, Label, Reading
from palpate.store import schema
from palpate.store.checks import check
from palpate.store.content import entry_plain
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.filters import Filter
from palpate.store.merging import merge_things
from palpate.store.opening import open_store
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from tests.fitting.made_up import START, WORKSHOP, drawn, fill, network_of, recordings_of
from tests.store.places import check_services, emptied

MUG = ThingRef("lab", "mug")
NONE = Setup()


@pytest.fixture
def network(tmp_path: Path) -> Network:
    return network_of(tmp_path)


@pytest.fixture(params=["sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    check_services(request.param)
    place = emptied() if request.param == "postgresql" else tmp_path / "store.sqlite"
    with open_store(place, tmp_path / "blobs", durable=False) as found:
        yield found


def put(
    store: Store, *entries: Entry, action: str = "weigh", true: bool = False, thing: ThingRef = MUG, setup: Setup = NONE
) -> None:
    """A recording at a time of its own; as a store has it that took it before truths had to be possible."""
    with store.engine.connect() as connection:
        before = len(connection.execute(select(schema.recordings.c.id)).all())
    moment = START + timedelta(seconds=before)
    recording = Recording(moment, action, thing, setup, entries=entries, ground_truth=true)
    check(recording, is_new=False)
    store.put_checked([recording])


def know(store: Store, name: str, entry: Entry) -> None:
    """A row of thing_properties, for an object that is there."""
    with store.engine.begin() as connection:
        thing = connection.execute(select(schema.things.c.id).where(schema.things.c.name == name)).scalar_one()
        row = {
            "thing_id": thing,
            "property": entry.property,
            "source": "a scale",
            "document": json.dumps(entry_plain(entry)),
        }
        connection.execute(insert(schema.thing_properties).values(**row))


def test_what_was_put_is_read(store: Store, network: Network) -> None:
    """Specimens come back from a store, whatever the order in which their recordings came."""
    specimens = drawn(network, 6, 1)
    fill(store, network, specimens)
    data = read_store(store, network)
    assert [one.name for one in data.specimens] == [f"made_up/{one.name}" for one in specimens]
    for found, was in zip(data.specimens, specimens, strict=True):
        assert set(found.truth) == set(was.truth)
        for name, value in was.truth.items():
            assert found.truth[name] == (value if isinstance(value, str) else pytest.approx(value))
        assert {a: sorted(map(str, got)) for a, got in found.readings.items()} == {
            a: sorted(map(str, got)) for a, got in was.readings.items()
        }
    (source,) = data.sources
    assert (source.kind, source.items) == ("store", 6 * 6)
    assert source.name == ("store.sqlite" if store.engine.dialect.name == "sqlite" else str(store.engine.url))
    assert source.first.startswith("2024-05-01T12:00:01")


def test_the_digest_is_that_of_the_content(store: Store, network: Network, tmp_path: Path) -> None:
    """Another store with the same recordings has the same digest, whatever their order; one more changes it."""
    recordings = recordings_of(network, drawn(network, 4, 2))
    store.put_many(recordings)
    first = read_store(store, network).sources[0].sha256
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        other.put_many(sorted(recordings, key=lambda one: (not one.ground_truth, str(one.id))))
        assert read_store(other, network).sources[0].sha256 == first
        put(other, Value("mass", 3.0, unit="g"), thing=recordings[0].thing)
        assert read_store(other, network).sources[0].sha256 != first


def test_ground_truth_is_no_reading(store: Store, network: Network) -> None:
    """A recording that is known to be true is the truth, in the network's unit, and no reading of a sensor."""
    put(store, Value("mass", 0.02, unit="kg"), true=True)
    put(store, Value("mass", 22.0, unit="g"))
    (mug,) = read_store(store, network).specimens
    assert mug == Specimen("lab/mug", {"mass": 20.0}, {"weigh": (Reading(22.0),)})


def test_known_properties_are_read(store: Store, network: Network) -> None:
    """What people know of an object counts as what was recorded as true; of several numbers the median does."""
    put(store, Value("mass", 10.0, unit="g"), true=True)
    put(store, Value("mass", 30.0, unit="g"), true=True)
    know(store, "mug", Value("mass", 0.012, unit="kg"))
    know(store, "mug", Distribution("kind", {"nut": 1.0}))
    know(store, "mug", Value("colour", 3.0, unit="nm"))
    assert len(list(known_properties(store))) == 5
    (mug,) = read_store(store, network).specimens
    assert mug.truth == {"kind": "nut", "mass": 12.0}


def test_what_cannot_be_known_is_told(store: Store, network: Network) -> None:
    """Contradictions, doubts, foreign states, units and kinds are left out, and each is told."""
    know_nothing: list[Entry] = [
        Distribution("kind", {"bolt": 1.0}),
        Distribution("kind", {"nut": 1.0}),
        Distribution("metal", {"steel": 0.6, "brass": 0.4}),
        Distribution("metal", {"gold": 1.0}),
        Value("density", 7.8),
        Value("volume", -1.0, unit="cm^3"),
        Value("mass", 3.0, unit="g"),
        Bound("mass", above=3.0, unit="g"),
        FailedEntry("slipped", "mass"),
    ]
    put(store, *know_nothing, true=True)
    data = read_store(store, network)
    assert data.specimens == (Specimen("lab/mug", {"mass": 3.0}),)
    told = "\n".join(data.notices)
    for part in (
        "known kind: contradicting labels of one object; left out",
        "known metal: found no label with a probability of at least 0.99; left out",
        "known metal: found the unknown state 'gold' of 'metal'; choose from 'steel', 'brass', 'zinc'; left out",
        "known density: found a value without a unit; left out",
        "known volume: found -1 cm^3; expected 'volume' above 0 cm^3",
        "known mass: found bound; expected a value; left out",
    ):
        assert part in told
    assert len(data.notices) == 6


def test_what_is_no_reading_is_told(store: Store, network: Network) -> None:
    """Failures, foreign actions, labels and properties, intervals and numbers without a unit are left out and told."""
    put(store, Value("mass", 20.0, unit="g"), true=True)
    put(store, Value("mass", 21.0, unit="g"))
    put(store, Bound("mass", above=35.0, unit="g"))
    put(store, Bound("mass", below=0.001, unit="kg"))
    put(store, Value("mass", 40.0, unit="g"))
    put(store, Distribution("kind", {"bolt": 0.5, "nut": 0.3, "else": 0.2}), action="look")
    for _ in range(2):
        put(store, FailedEntry("slipped"))
    put(store, Interval("mass", 1.0, 2.0, "g"))
    put(store, Value("mass", 3.0))
    put(store, Value("density", 3.0, unit="g/cm^3"))
    put(store, Value("mass", 3.0, unit="g"), action="shake")
    put(store, Distribution("kind", {"key": 1.0}), action="look")
    data = read_store(store, network)
    (mug,) = data.specimens
    assert sorted(map(str, mug.readings["weigh"])) == sorted(
        map(str, (Reading(21.0), Above(35.0), Above(35.0), Below(1.0)))
    )
    assert mug.readings["look"] == (Label("bolt"),)
    assert sorted(data.notices) == sorted(
        (
            "weigh: failed on lab/mug 2 times, at first with: slipped; left out",
            "weigh: an interval, which no sensor model gives; left out",
            "weigh: a number without a unit; left out",
            "results of 'density' by 'weigh', which measures 'mass'; left out",
            "results of action 'shake', which the network has not; left out",
            "action 'look': unknown label 'key'; choose from 'bolt', 'nut', 'else'; left out",
        )
    )


def test_merged_objects_are_one(store: Store, network: Network) -> None:
    """What is known of an object, and was measured on it, counts as of the one that it is merged into."""
    cup = ThingRef("shop", "cup")
    put(store, Value("mass", 20.0, unit="g"), true=True)
    put(store, Value("mass", 21.0, unit="g"), thing=cup)
    put(store, Distribution("kind", {"nut": 1.0}), true=True, thing=cup)
    merge_things(store, cup, MUG)
    (mug,) = read_store(store, network).specimens
    assert mug == Specimen("lab/mug", {"kind": "nut", "mass": 20.0}, {"weigh": (Reading(21.0),)})


def test_a_filter_is_about_readings(store: Store, network: Network) -> None:
    """The readings of one gripper are taken alone, what is known of objects always; of a dataset only its objects."""
    grippers = [Setup(gripper=Device("gripper", name)) for name in ("soft", "hard")]
    put(store, Value("mass", 20.0, unit="g"), true=True)
    for value, setup in zip((19.0, 25.0), grippers, strict=True):
        put(store, Value("mass", value, unit="g"), setup=setup)
    put(store, Value("mass", 5.0, unit="g"), true=True, thing=ThingRef("shop", "cup"))
    soft = read_store(store, network, Filter(gripper="soft"))
    assert [one.truth for one in soft.specimens] == [{"mass": 20.0}, {"mass": 5.0}]
    assert soft.specimens[0].readings["weigh"] == (Reading(19.0),)
    assert [one.name for one in read_store(store, network, Filter(dataset="shop")).specimens] == ["shop/cup"]


def test_a_store_that_knows_nothing(store: Store, network: Network) -> None:
    """Without known properties there is nothing to learn from, and the error says what would be."""
    put(store, Value("mass", 20.0, unit="g"))
    told = "found no known properties of any object; expected recordings marked as .*palpate store object know OBJECT"
    with pytest.raises(FittingError, match=told):
        read_store(store, network)


def test_what_a_camera_saw_of_a_trick_is_left_out(store: Store, tmp_path: Path) -> None:
    """It saw what the object looks like, and so says nothing of the object; other actions count."""
    text = WORKSHOP.replace("[actions.look]", "[actions.look]\nsees_appearance = true")
    network, trick = network_of(tmp_path, text), ThingRef("lab", "trick", attributes={"looks_like": "nut"})
    for thing in (MUG, trick):
        put(store, Distribution("kind", {"bolt": 1.0}), true=True, thing=thing)
        put(store, Distribution("kind", {"nut": 1.0}), action="look", thing=thing)
        put(store, Value("mass", 20.0, unit="g"), thing=thing)
    data = read_store(store, network)
    assert {one.name: set(one.readings) for one in data.specimens} == {
        "lab/mug": {"look", "weigh"},
        "lab/trick": {"weigh"},
    }
    assert "look: lab/trick looks like nut; left out" in data.notices
