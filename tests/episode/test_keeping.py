import threading
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from palpate.episode import About, record_episode
from palpate.episode.keeping import KeptEpisode, read_stored_episode
from palpate.explore import Step, explore
from palpate.inference.exact import ExactBelief
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.outcomes import Label, Likelihood, Outcome, Posterior, Reading
from palpate.recording import Spool, record
from palpate.robots.protocol import FunctionRobot, Robot
from palpate.robots.recorded import RecordedRobot
from palpate.robots.replay import ReplayRobot
from palpate.robots.sampled import SampledRobot
from palpate.robots.session import shipped_session
from palpate.robots.stored import stored_session
from palpate.selection.policies import FixedOrder
from palpate.selection.stopping import NothingLeft
from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.keeping_episodes import get_episode
from palpate.store.opening import open_store
from palpate.store.records import Recording, ThingRef
from palpate.store.store import Store
from palpate.store.verifying import verify
from palpate.summary import CategoricalSummary, ContinuousSummary

NETWORK = load_network("household-filled")
MUG = ThingRef("our lab", "mug")


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    return Spool(tmp_path / "spool", sync=False)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


def kept(store: Store, spool: Spool, robot: Robot) -> tuple[KeptEpisode, list[Step]]:
    """Explore with a robot, and keep the episode."""
    prior = ExactBelief(NETWORK)
    acting = RecordedRobot(robot, NETWORK, store, thing=MUG, spool=spool)
    episode, steps = KeptEpisode(store, acting, prior, About(object="mug")), []
    for step in explore(prior, acting):
        episode.write(step)
        steps.append(step)
    assert acting.troubles == []
    return episode, steps


def exotic() -> Robot:
    """Outcomes that entries alone do not say."""
    posterior = Posterior({"glass": 0.4, "hard-plastic": 0.6}, temperature=1.5)
    material = NETWORK.properties["material"]
    assert isinstance(material, CategoricalProperty)
    likelihood = Likelihood({state: float(place) for place, state in enumerate(material.states, 1)})
    functions: dict[str, Callable[[], Outcome]] = {
        "cat-vision": lambda: Label("mug"),
        "mat-vision": lambda: posterior,
        "mat-sound": lambda: likelihood,
        "weighing": lambda: Reading(0.118, sd=0.003, unit="kg"),
    }
    return FunctionRobot(functions)


ROBOTS: dict[str, Callable[[], Robot]] = {
    "sampled": lambda: SampledRobot(NETWORK, "ceramic_mug", np.random.default_rng(5)),
    "replay": lambda: ReplayRobot(shipped_session("banana_ycb").recorded),
    "exotic": exotic,
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("source", ["episode", "recordings"])
def test_a_replay_from_the_store_is_the_same_exploration(store: Store, spool: Spool, name: str, source: str) -> None:
    """Outcomes, choices and beliefs of a recorded exploration come again from its episode, or from its recordings."""
    episode, steps = kept(store, spool, ROBOTS[name]())
    if source == "episode":
        recorded = read_stored_episode(store, episode.id).recorded
        assert recorded == tuple((step.action, step.outcome) for step in steps[:-1])
    else:
        recorded = stored_session(store, "mug", NETWORK).recorded
    again = list(explore(ExactBelief(NETWORK), ReplayRobot(recorded)))
    for one, other in zip(steps[:-1], again[: len(steps) - 1], strict=True):
        assert (one.action, one.surprise) == (other.action, other.surprise)
        assert one.expected_gain_bits == pytest.approx(other.expected_gain_bits, abs=1e-12)
    before, after = (record_episode(ExactBelief(NETWORK), found).posterior for found in (steps, again[: len(steps)]))
    for prop in NETWORK.properties:
        one_summary, other_summary = before[prop], after[prop]
        if isinstance(one_summary, CategoricalSummary) and isinstance(other_summary, CategoricalSummary):
            assert one_summary.probabilities == pytest.approx(other_summary.probabilities, abs=1e-12)
        elif isinstance(one_summary, ContinuousSummary) and isinstance(other_summary, ContinuousSummary):
            assert one_summary.mean == pytest.approx(other_summary.mean, rel=1e-12)
            assert one_summary.quantiles == pytest.approx(other_summary.quantiles, rel=1e-12)
        else:
            raise AssertionError(prop)


def test_an_episode_is_the_same_as_its_log(store: Store, spool: Spool) -> None:
    """What the store gives back is what a log would, each step with its recording, and the store verifies."""
    episode, steps = kept(store, spool, ROBOTS["sampled"]())
    found = read_stored_episode(store, episode.id)
    expected = record_episode(ExactBelief(NETWORK), steps, About(object="mug"))
    assert (found.recorded, found.posterior, found.stop) == (expected.recorded, expected.posterior, expected.stop)
    *taken, _ = get_episode(store, episode.id).steps
    recordings = [store.get(step.recording or "") for step in taken]
    assert [recording.action for recording in recordings] == [step.action for step in steps[:-1]]
    assert all(recording.thing == MUG for recording in recordings)
    assert list(verify(store)) == []
    assert (spool.waiting(), spool.unfinished()) == ([], {})


def test_functions_that_record_themselves_are_linked(store: Store, spool: Spool) -> None:
    """The episode links to the recording that a decorated function makes, and there is no second one."""

    @record("weighing", thing=MUG, property="mass", spool=spool)
    def weigh() -> Outcome:
        return Reading(118.0, unit="g")

    episode, steps = kept(store, spool, FunctionRobot({"weighing": weigh, "cat-vision": lambda: Label("mug")}))
    links = {step.record["action"]: step.recording for step in get_episode(store, episode.id).steps[:-1]}
    assert store.get(links["weighing"] or "").entries == (Value("mass", 118.0, None, "g"),)
    with store.engine.connect() as connection:
        assert connection.exec_driver_sql("SELECT count(*) FROM recordings").scalar() == len(steps) - 1


def test_an_interrupted_exploration_is_kept_until_then(store: Store, spool: Spool) -> None:
    """After an interrupt in the third action the store has two steps, and a failed recording of the third."""

    def interrupted() -> Outcome:
        raise KeyboardInterrupt

    robot = RecordedRobot(
        FunctionRobot({"cat-vision": lambda: Label("mug"), "weighing": lambda: Reading(1.0), "squeezing": interrupted}),
        NETWORK,
        store,
        thing=MUG,
        spool=spool,
    )
    prior = ExactBelief(NETWORK)
    episode = KeptEpisode(store, robot, prior)
    order = FixedOrder(["cat-vision", "weighing", "squeezing"])

    def run() -> None:
        for step in explore(prior, robot, policy=order, stopping=NothingLeft()):
            episode.write(step)

    with pytest.raises(KeyboardInterrupt):
        run()
    found = read_stored_episode(store, episode.id)
    assert ([step.action for step in found.steps], found.stop) == (["cat-vision", "weighing"], None)
    with store.engine.connect() as connection:
        actions = connection.exec_driver_sql("SELECT action FROM recordings ORDER BY id").scalars().all()
    assert actions == ["cat-vision", "weighing", "squeezing"]
    assert list(verify(store)) == []


def test_a_step_that_timed_out_has_no_recording_yet(store: Store, spool: Spool) -> None:
    """The step is kept as failed without a link, and the next action has its own."""
    go, done = threading.Event(), threading.Event()

    def slow() -> Outcome:
        go.wait()
        done.set()
        return Reading(1.0)

    robot = RecordedRobot(
        FunctionRobot({"weighing": slow, "cat-vision": lambda: Label("mug")}), NETWORK, store, thing=MUG, spool=spool
    )
    prior = ExactBelief(NETWORK)
    episode = KeptEpisode(store, robot, prior)
    order = FixedOrder(["weighing", "cat-vision"])
    for step in explore(prior, robot, policy=order, stopping=NothingLeft(), timeout_s=0.5):
        episode.write(step)
    first, second, _ = get_episode(store, episode.id).steps
    assert (first.record["outcome"]["failed"], first.recording) == (True, None)
    assert store.get(second.recording or "").action == "cat-vision"
    go.set()
    assert done.wait(10)
    for thread in threading.enumerate():
        if thread.name == "palpate weighing":
            thread.join()


def test_a_store_of_other_units_is_refused(store: Store, spool: Spool) -> None:
    """Before anything is measured it is told that a property has another dimension in the store."""
    entries = (Value("firmness", 1.0, unit="kPa"),)
    store.put(Recording(datetime(2024, 5, 1, tzinfo=UTC), "pressing", MUG, entries=entries))
    pantry = load_network("pantry")
    robot = RecordedRobot(FunctionRobot({}), pantry, store, thing=MUG, spool=spool)
    with pytest.raises(StoreError, match="property 'firmness' of the network 'pantry': unit 'N/mm' is mass"):
        KeptEpisode(store, robot, ExactBelief(pantry))
