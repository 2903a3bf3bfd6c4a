from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from palpate.errors import LogError
from palpate.network.reading import load_network
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Posterior, Reading
from palpate.recording.results import OUTCOME
from palpate.robots.stored import stored_session
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.errors import StoreError
from palpate.store.merging import merge_things
from palpate.store.opening import open_store
from palpate.store.records import FileItem, Recording, ThingRef
from palpate.store.store import Store

NETWORK = load_network("household")
MUG = ThingRef("our lab", "mug")
START = datetime(2024, 5, 1, tzinfo=UTC)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


def put(store: Store, minute: int, action: str, *entries: Entry, **fields: Any) -> None:
    moment = START + timedelta(minutes=minute)
    store.put(Recording(moment, action, **{"thing": MUG, "entries": entries, **fields}))


def test_outcomes_come_in_the_order_of_recording(store: Store) -> None:
    """Each kind of entry is the outcome that it stands for, in the order of time and not of arrival."""
    put(store, 3, "weighing", Value("mass", 119.0, 4.0, "g"))
    put(store, 1, "weighing", Value("mass", 118.0, None, "g"))
    put(store, 2, "cat-vision", Distribution("category", {"mug": 1.0}))
    put(store, 4, "mat-sound", Distribution("material", {"glass": 0.4, "metal": 0.6}))
    put(store, 5, "squeezing", Bound("elasticity", above=95.0, unit="kPa"))
    put(store, 6, "squeezing", Bound("elasticity", below=5.0, unit="kPa"))
    put(store, 7, "squeezing", FailedEntry("broke"))
    session = stored_session(store, "mug", NETWORK)
    assert session.recorded == (
        ("weighing", Reading(118.0, None, "g")),
        ("cat-vision", Label("mug")),
        ("weighing", Reading(119.0, 4.0, "g")),
        ("mat-sound", Posterior({"glass": 0.4, "metal": 0.6})),
        ("squeezing", Above(95.0, unit="kPa")),
        ("squeezing", Below(5.0, unit="kPa")),
        ("squeezing", Failed("broke")),
    )
    assert any("its SD of 4 takes the place of the sensor's" in decision for decision in session.all_decisions)


def test_the_outcome_itself_goes_before_its_entry(store: Store) -> None:
    """A file with the outcome says it as it was."""
    item = FileItem(OUTCOME, "application/json", b'{"action": "mat-sound", "likelihood": {"glass": 3.0, "metal": 1.0}}')
    put(store, 1, "mat-sound", Distribution("material", {"glass": 0.75, "metal": 0.25}), files=(item,))
    assert stored_session(store, "mug", NETWORK).recorded == (("mat-sound", Likelihood({"glass": 3.0, "metal": 1.0})),)


def test_what_cannot_be_replayed_is_told(store: Store) -> None:
    """Ground truth, unknown actions, intervals, other or several results: each is left out with the reason."""
    put(store, 0, "weighing", Value("mass", 118.0, None, "g"))
    put(store, 1, "weighing", Value("mass", 118.1, None, "g"), ground_truth=True)
    put(store, 2, "photo")
    put(store, 3, "squeezing", Interval("elasticity", 1.0, 2.0, "kPa"))
    put(store, 4, "squeezing", Value("volume", 1.0, None, "cm^3"))
    put(store, 5, "weighing", Value("mass", 1.0, None, "g"), Value("mass", 2.0, None, "g"))
    put(store, 6, "weighing", files=(FileItem(OUTCOME, "application/json", b"{"),))
    session = stored_session(store, "mug", NETWORK)
    assert len(session.recorded) == 1
    reasons = (
        "is left out: it is known to be true",
        "the network 'household' has no such action",
        "an interval of elasticity",
        "no result of elasticity",
        "2 results of mass",
        "its outcome.json cannot be read",
    )
    for decision, reason in zip(session.decisions, reasons, strict=True):
        assert reason in decision


def test_merged_objects_are_replayed_as_one(store: Store) -> None:
    """What was recorded of an object merged into another is replayed with it."""
    cup = ThingRef("elsewhere", "cup")
    put(store, 1, "weighing", Value("mass", 118.0, None, "g"))
    put(store, 2, "weighing", Value("mass", 119.0, None, "g"), thing=cup)
    merge_things(store, cup, MUG)
    assert len(stored_session(store, "our lab/mug", NETWORK).recorded) == 2
    assert len(stored_session(store, "cup", NETWORK).recorded) == 1


def test_nothing_to_replay_is_an_error(store: Store) -> None:
    """An object that is not there, or of which there is nothing, is named."""
    put(store, 1, "photo")
    with pytest.raises(LogError, match="object 'mug': none of its 1 recordings has an outcome to replay"):
        stored_session(store, "mug", NETWORK)
    with pytest.raises(StoreError, match="object 'cup': is not in the store"):
        stored_session(store, "cup", NETWORK)
