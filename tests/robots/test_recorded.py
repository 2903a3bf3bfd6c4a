import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.client import UnreachableError
from palpate.network.reading import load_network
from palpate.outcomes import Above, Failed, Label, Likelihood, Outcome, Posterior, Reading
from palpate.recording import About, Spool, current_recording, record
from palpate.recording.results import OUTCOME
from palpate.robots.contract import RobotContract
from palpate.robots.protocol import FunctionRobot
from palpate.robots.recorded import RecordedRobot
from palpate.robots.sampled import SampledRobot
from palpate.store.entries import Bound, Distribution, FailedEntry, Value
from palpate.store.opening import open_store
from palpate.store.records import Device, Receipt, Recording, Setup, ThingRef
from palpate.store.store import Store

NETWORK = load_network("household")
MUG = ThingRef("our lab", "mug")
PROBABILITIES = {"glass": 0.5, "metal": 0.5}


class Shelf:
    """Takes what it is given."""

    def put(self, recording: Recording) -> Receipt:
        return Receipt(recording.id, recording.digest, new=True)


class TestRecordedRobot(RobotContract):
    network = load_network("household-filled")

    @pytest.fixture(autouse=True)
    def _spool(self, tmp_path: Path) -> None:
        self.spool = Spool(tmp_path / "spool", sync=False)

    def make_robot(self) -> RecordedRobot:
        inner = SampledRobot(self.network, "ceramic_mug", np.random.default_rng(0))
        return RecordedRobot(inner, self.network, Shelf(), thing=MUG, spool=self.spool)


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    return Spool(tmp_path / "spool", sync=False)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


Make = Callable[[Mapping[str, Callable[[], Outcome]]], RecordedRobot]


@pytest.fixture
def robot(store: Store, spool: Spool) -> Make:
    def make(functions: Mapping[str, Callable[[], Outcome]]) -> RecordedRobot:
        return RecordedRobot(FunctionRobot(functions), NETWORK, store, thing=MUG, spool=spool)

    return make


def recorded(store: Store, robot: RecordedRobot) -> Recording:
    """What the last action has recorded; it is in the store, and nothing of it waits in the spool."""
    digest = robot.end_step()
    assert digest is not None
    return store.get(digest)


@pytest.mark.parametrize(
    ("action", "outcome", "entry"),
    [
        ("weighing", Reading(118.0), Value("mass", 118.0, None, "g")),
        ("weighing", Reading(0.118, sd=0.006, unit="kg"), Value("mass", 0.118, 0.006, "kg")),
        ("squeezing", Above(95.0), Bound("elasticity", above=95.0, unit="kPa")),
        ("cat-vision", Label("mug"), Distribution("category", {"mug": 1.0})),
        ("mat-sound", Posterior(PROBABILITIES), Distribution("material", PROBABILITIES)),
        ("squeezing", Failed("lost the grip"), FailedEntry("lost the grip", "elasticity")),
    ],
)
def test_an_outcome_is_an_entry(
    robot: Make, store: Store, spool: Spool, action: str, outcome: Outcome, entry: object
) -> None:
    """The outcome is returned as it was, and recorded with the property that the action measures and its unit."""
    acting = robot({action: lambda: outcome})
    assert acting.perform(action) == outcome
    found = recorded(store, acting)
    assert (found.action, found.thing, found.entries, found.files) == (action, MUG, (entry,), ())
    assert spool.waiting() == []


@pytest.mark.parametrize(
    "outcome",
    [
        Posterior(PROBABILITIES, temperature=1.5),
        Posterior({"glass": 1.0}),
        Likelihood({"glass": 3.0, "metal": 1.0}),
        Above(95.0, sd=3.0, unit="kPa"),
    ],
)
def test_what_entries_cannot_say_is_in_a_file(robot: Make, store: Store, outcome: Outcome) -> None:
    """Where the entry is less than the outcome, the outcome itself is kept beside it."""
    acting = robot({"squeezing": lambda: outcome})
    acting.perform("squeezing")
    assert [item.name for item in recorded(store, acting).files] == [OUTCOME]


def test_a_robot_can_tell_more(robot: Make, store: Store) -> None:
    """Signals, output and the robot's own setup are in the recording."""

    def weigh() -> Outcome:
        current_recording().series("scale", load=[117.0, 119.0], units={"load": "g"}, rate_hz=10.0)
        sys.stdout.write("steady\n")
        return Reading(118.0, unit="g")

    acting = robot({"weighing": weigh})
    acting.setup = Setup(arm=Device("arm", "kinova_gen3"))
    acting.perform("weighing")
    found = recorded(store, acting)
    assert (found.series[0].name, found.log, found.setup.arm) == ("scale", "steady\n", acting.setup.arm)


def test_a_robot_tells_its_setup(store: Store, spool: Spool) -> None:
    """The devices are those that the robot has as its setup, unless others are given."""

    class Equipped(FunctionRobot):
        setup = Setup(arm=Device("arm", "kinova_gen3"))

    inner = Equipped({"weighing": lambda: Reading(1.0)})
    assert RecordedRobot(inner, NETWORK, store, thing=MUG, spool=spool).setup == Equipped.setup
    other = Setup(arm=Device("arm", "another"))
    assert RecordedRobot(inner, NETWORK, store, thing=MUG, spool=spool, setup=other).setup == other


def test_an_action_that_records_itself_is_recorded_once(robot: Make, store: Store, spool: Spool) -> None:
    """The recording of a decorated function is the action's, also where it raises; it goes to the same store."""
    about = About(owner="lab", software="scale 2")

    @record("weighing", thing=MUG, property="mass", about=about, spool=spool)
    def weigh(value: float) -> Outcome:
        if value < 0:
            raise ValueError("no load")
        return Reading(value, unit="g")

    values = iter([118.0, -1.0])
    acting = robot({"weighing": lambda: weigh(next(values))})
    acting.perform("weighing")
    assert recorded(store, acting).owner == "lab"
    with pytest.raises(ValueError, match="no load"):
        acting.perform("weighing")
    assert recorded(store, acting).entries == (FailedEntry("ValueError: no load"),)
    assert (spool.waiting(), spool.unfinished()) == ([], {})


def test_another_recording_on_the_way_is_kept_beside(robot: Make, store: Store, spool: Spool) -> None:
    """A decorated function of another action is recorded, sent, and not taken for the action's own recording."""

    @record("photo", thing=MUG, spool=spool)
    def photograph() -> None:
        current_recording().file("cam0.txt", "a picture")

    def weigh() -> Outcome:
        photograph()
        return Reading(118.0, unit="g")

    acting = robot({"weighing": weigh})
    acting.perform("weighing")
    assert recorded(store, acting).action == "weighing"
    assert spool.waiting() == []


def test_failures_are_recorded(robot: Make, store: Store) -> None:
    """What the robot raises is raised, and recorded as failed with its log."""

    def broken() -> Outcome:
        raise OSError("no answer")

    acting = robot({"weighing": broken})
    with pytest.raises(OSError, match="no answer"):
        acting.perform("weighing")
    found = recorded(store, acting)
    assert found.entries == (FailedEntry("OSError: no answer"),)
    assert "Traceback" in found.log


def test_an_action_that_ends_too_late_says_so(robot: Make, store: Store) -> None:
    """What comes after the step is over is kept, and is no recording of the next step."""
    go, done = threading.Event(), threading.Event()

    def slow() -> Outcome:
        go.wait()
        return Reading(118.0, unit="g")

    acting = robot({"weighing": slow})

    def perform() -> None:
        acting.perform("weighing")
        done.set()

    threading.Thread(target=perform).start()
    assert acting.end_step() is None
    go.set()
    assert done.wait(10)
    assert acting.end_step() is None
    with store.engine.connect() as connection:
        (digest,) = connection.exec_driver_sql("SELECT digest FROM recordings").scalars()
    assert store.get(digest.hex()).notices == ("it came after it was given up",)


class Away:
    """A receiver that nobody reaches."""

    def put(self, recording: Recording) -> Receipt:
        raise UnreachableError("no answer")


def test_what_cannot_be_sent_waits_in_the_spool(spool: Spool) -> None:
    """The outcome is returned all the same, and what is wrong is told."""
    inner = FunctionRobot({"weighing": lambda: Reading(118.0, unit="g")})
    acting = RecordedRobot(inner, NETWORK, Away(), thing=MUG, spool=spool)
    assert acting.perform("weighing") == Reading(118.0, unit="g")
    assert acting.end_step() is None
    assert [spool.read(name).action for name in spool.waiting()] == ["weighing"]
    (trouble,) = acting.troubles
    assert "is waiting in" in trouble
    assert "no answer" in trouble


def test_notices_stand_in_each_recording(store: Store, spool: Spool) -> None:
    """What is odd about all recordings of a robot is said in each of them."""
    inner: Any = FunctionRobot({"weighing": lambda: Reading(118.0, unit="g")})
    acting = RecordedRobot(inner, NETWORK, store, thing=MUG, spool=spool, notices=["drawn, not measured"])
    acting.perform("weighing")
    assert recorded(store, acting).notices == ("drawn, not measured",)


class Busy(Spool):
    """A spool in which somebody else has each recording in hand, and does something with it at the third look."""

    def __init__(self, folder: Path, then: Callable[[Spool, str], object]) -> None:
        super().__init__(folder, sync=False)
        self.then, self.looks = then, 0

    @contextmanager
    def claimed(self, name: str) -> Iterator[bool]:
        self.looks += 1
        if self.looks == 3:
            with super().claimed(name):
                self.then(self, name)
        yield False


def shared(folder: Path, store: Store, then: Callable[[Spool, str], object]) -> RecordedRobot:
    inner = FunctionRobot({"weighing": lambda: Reading(118.0, unit="g")})
    return RecordedRobot(inner, NETWORK, store, thing=MUG, spool=Busy(folder, then))


def test_what_another_program_sends_is_waited_for(store: Store, tmp_path: Path) -> None:
    """A recording that somebody else is sending counts once it has left the spool, and not before."""

    def send_it(spool: Spool, name: str) -> None:
        store.put(spool.read(name))
        spool.remove(name)

    acting = shared(tmp_path / "spool", store, send_it)
    acting.perform("weighing")
    assert recorded(store, acting).action == "weighing"
    assert acting.troubles == []


def test_what_another_program_could_not_send_is_told(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Refused there, or in hand for too long, a recording is not taken for one that is stored."""
    acting = shared(tmp_path / "refused", store, lambda spool, name: spool.refuse(name, "no such owner"))
    acting.perform("weighing")
    assert acting.end_step() is None
    assert "no such owner" in acting.troubles[0]
    monkeypatch.setattr("palpate.robots.recorded.PATIENCE_S", 0.0)
    acting = shared(tmp_path / "stuck", store, lambda spool, name: None)
    acting.perform("weighing")
    assert acting.end_step() is None
    assert "somebody else" in acting.troubles[0]
