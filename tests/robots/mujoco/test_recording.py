from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.episode.keeping import KeptEpisode
from palpate.explore import explore
from palpate.inference.exact import ExactBelief
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Label, Outcome, Posterior, Reading
from palpate.recording import Spool
from palpate.recording.errors import RecordingError
from palpate.robots.mujoco.estimates import estimates
from palpate.robots.mujoco.noise import QUIET, BenchNoise
from palpate.robots.mujoco.recording import bench_setup, keep_in_recording
from palpate.robots.mujoco.robot import MujocoRobot
from palpate.robots.recorded import RecordedRobot
from palpate.robots.recorded_signals import estimated_again, signals_in
from palpate.robots.signals import ImageSignals, Signals, SoundSignals
from palpate.selection.stopping import NothingLeft
from palpate.store.opening import open_store
from palpate.store.records import Recording, ThingRef
from palpate.store.store import Store

NETWORK = load_network("household-filled")


def ringing(signals: SoundSignals) -> Outcome:
    loud = float(np.abs(signals.samples[-8000:]).mean() / np.abs(signals.samples).max())
    return Posterior({"metal": loud, "foam": 1 - loud})


def red(signals: ImageSignals) -> Outcome:
    share = float(signals.image[..., 0].mean()) / 255
    return Posterior({"fruit": share, "mug": 1 - share})


def looks(signals: ImageSignals) -> Outcome:
    return Label("wood" if signals.image.std() > 40 else "ceramic")


ALL: dict[str, Any] = {**estimates(NETWORK), "mat-sound": ringing, "cat-vision": red, "mat-vision": looks}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


class Bench:
    """Does actions on a bench whose recordings go into a store, and remembers the signals."""

    def __init__(self, store: Store, spool: Path, thing: str, noise: BenchNoise, **skills: Any) -> None:
        self.signals: dict[str, Signals] = {}
        self.robot = MujocoRobot.of(
            NETWORK, thing, {**ALL, **skills}, noise=noise, rng=np.random.default_rng(4), record=self.keep
        )
        self.recorded = RecordedRobot(
            self.robot,
            NETWORK,
            store,
            thing=ThingRef("simulated-bench", thing),
            setup=bench_setup(self.robot.bench),
            spool=Spool(spool, sync=False),
        )

    def keep(self, action: str, signals: Signals, outcome: Outcome) -> None:
        self.signals[action] = signals
        keep_in_recording(self.robot.bench, signals)


def same(one: object, other: object) -> bool:
    """Whether two records of signals hold the same arrays and numbers, bit by bit."""
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and one.dtype == other.dtype and np.array_equal(one, other)
    if isinstance(one, tuple):
        return isinstance(other, tuple) and len(one) == len(other) and all(map(same, one, other))
    if is_dataclass(one):
        return type(one) is type(other) and all(
            same(getattr(one, entry.name), getattr(other, entry.name)) for entry in fields(one)
        )
    return one == other


def test_a_recorded_exploration_can_be_estimated_again(drawing: None, store: Store, tmp_path: Path) -> None:
    """Signals come back from the store as they were, and the estimators make the same outcomes of them."""
    bench = Bench(store, tmp_path / "spool", "banana_ycb", BenchNoise())
    belief = ExactBelief(NETWORK)
    with bench.robot:
        episode = KeptEpisode(store, bench.recorded, belief)
        outcomes = {}
        for step in explore(belief, bench.recorded, stopping=NothingLeft()):
            episode.write(step)
            outcomes[step.action] = step.outcome
    assert bench.recorded.troubles == []
    found: dict[Any, Recording] = {
        step.record["action"]: store.get(step.recording) for step in episode.stored.steps if step.recording
    }
    assert found.keys() == ALL.keys()
    for action, recording in found.items():
        assert same(signals_in(recording), bench.signals[action]), action
        assert estimated_again(recording, ALL) == outcomes[action]


def test_recordings_tell_units_rates_devices_and_poses(drawing: None, store: Store, tmp_path: Path) -> None:
    """Each channel has its unit and rate; each device says that it is simulated; poses are where things are."""
    bench = Bench(store, tmp_path / "spool", "ceramic_mug", QUIET)
    found = {}
    with bench.robot:
        for action in ALL:
            bench.recorded.perform(action)
            found[action] = store.get(bench.recorded.end_step() or "")
    channels: dict[Any, Any] = {
        (one.name, channel.name): (channel.unit, channel.rate_hz)
        for one in found["weighing"].series
        for channel in one.channels
    }
    assert sum(name.endswith("_torque") for series, name in channels if series == "arm") == 7
    assert channels["arm", "half_arm_1_torque"] == ("N*m", pytest.approx(100))
    assert channels["arm_empty", "bracelet_torque"][0] == "N*m"
    assert channels["arm", "forearm_angle"][0] == "rad"
    told = {channel.name: channel.unit for channel in found["squeezing"].series[0].channels}
    assert told == {"gap": "mm", "force": "N", "position": "1", "current": "A"}
    assert [item.name for item in found["cat-vision"].files if item.media_type == "image/png"] == ["image.png"]
    assert "sound.wav" in [item.name for item in found["mat-sound"].files]
    setup = found["weighing"].setup
    assert [device.kind for device in setup.devices] == ["arm", "gripper", "camera", "microphone", "other"]
    assert all(device.parameters["simulated"] is True for device in setup.devices)
    assert not any(recording.ground_truth for recording in found.values())
    gripper, mug = found["weighing"].gripper_pose, found["weighing"].object_pose
    assert gripper is not None
    assert mug is not None
    # it hangs from the gripper in the weighing pose, and stands on the table when it is seen
    np.testing.assert_allclose(gripper.translation_m, (0.60, 0.0, 0.36), atol=2e-3)
    np.testing.assert_allclose(mug.translation_m[:2], gripper.translation_m[:2], atol=2e-2)
    stood = found["cat-vision"].object_pose
    assert stood is not None
    assert stood.translation_m[2] < mug.translation_m[2] - 0.2


def test_what_is_kept_beside_does_not_change_what_is_measured(drawing: None, store: Store, tmp_path: Path) -> None:
    """Recorded or not, the same seed gives the same outcomes."""
    bench = Bench(store, tmp_path / "spool", "soft_brick_ycb", BenchNoise())
    plain = MujocoRobot.of(NETWORK, "soft_brick_ycb", ALL, rng=np.random.default_rng(4))
    with bench.robot, plain:
        for action in ("weighing", "squeezing", "weighing", "mat-sound"):
            assert bench.recorded.perform(action) == plain.perform(action)


def test_a_failed_action_keeps_its_signals(store: Store, tmp_path: Path) -> None:
    """A grasp that misses is a failed result, with the torques that say so."""
    bench = Bench(store, tmp_path / "spool", "ceramic_mug", replace(QUIET, miss_probability=1.0))
    with bench.robot:
        outcome = bench.recorded.perform("weighing")
    recording = store.get(bench.recorded.end_step() or "")
    assert isinstance(outcome, Failed)
    assert estimated_again(recording, ALL) == outcome
    assert {one.name for one in recording.series} == {"arm", "arm_empty", "gripper"}


def test_recordings_without_signals_are_named(store: Store, tmp_path: Path) -> None:
    """A recording that holds no signals, or only a part of them, or is of another action, says what is missing."""
    bench = Bench(store, tmp_path / "spool", "ceramic_mug", QUIET)
    with bench.robot:
        bench.recorded.perform("squeezing")
    whole = store.get(bench.recorded.end_step() or "")
    with pytest.raises(RecordingError, match="of squeezing holds no signals that can be estimated from; expected"):
        signals_in(replace(whole, series=()))
    with pytest.raises(RecordingError, match="of squeezing: 'rest_width_mm' is missing"):
        signals_in(replace(whole, grasp={"contact_area_mm2": 825.0}))
    with pytest.raises(RecordingError, match="no estimator for action 'squeezing': choose from 'weighing'"):
        estimated_again(whole, {"weighing": lambda signals: Reading(1.0)})


def test_people_see_the_scene_where_the_camera_does_not_look(drawing: None, store: Store, tmp_path: Path) -> None:
    """A weighing shows the lifted object; signals are the same with and without the picture."""
    bench = Bench(store, tmp_path / "spool", "ceramic_mug", QUIET)
    with bench.robot:
        bench.recorded.perform("weighing")
    found = store.get(bench.recorded.end_step() or "")
    (picture,) = [item for item in found.files if item.media_type == "image/png"]
    assert picture.name == "scene.png"
    assert isinstance(picture.data, bytes)
    assert picture.data.startswith(b"\x89PNG")
    assert same(signals_in(found), bench.signals["weighing"])


def test_signals_are_kept_where_nothing_can_draw(store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without graphics weighs as ever; the recording says why it has no picture."""

    def blind(*_: object) -> None:
        raise RuntimeError("no display")

    monkeypatch.setattr("mujoco.Renderer", blind)
    bench = Bench(store, tmp_path / "spool", "ceramic_mug", QUIET)
    with bench.robot:
        bench.recorded.perform("weighing")
    found = store.get(bench.recorded.end_step() or "")
    assert found.series
    assert not [item for item in found.files if item.media_type == "image/png"]
    assert [one for one in found.notices if one.startswith("without a picture of the scene: the bench's camera")]
