"""The examples of real robots run against stand-ins for their makers' packages."""

import re
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from palpate.network.reading import load_network
from palpate.outcomes import Failed, Label, Reading
from palpate.recording import Spool, record
from palpate.robots.contract import RobotContract
from palpate.robots.protocol import Robot
from palpate.robots.recorded import RecordedRobot
from palpate.robots.recorded_signals import signals_in
from palpate.robots.signals import ImageSignals, SqueezeSignals, WeighSignals
from palpate.robots.trial import attempt
from palpate.store.opening import open_store
from palpate.store.records import Setup, ThingRef
from palpate.store.store import Store
from tests.docs.stand_ins import NEWTON_PER_AMPERE, Node, World, kortex, ros

PAGES = Path(__file__).parents[2] / "docs" / "robots"
NETWORK = load_network("household")
POSES: dict[str, tuple[float, ...]] = {"above": (0.0,) * 7, "around": (0.1,) * 7, "weighing": (0.2,) * 7}
LEVERS_M = {1: -0.6, 3: 0.35}
JOINTS = [f"joint_{number}" for number in range(1, 8)]


def defined(page: str, modules: dict[str, ModuleType], patch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What the Python blocks of a page define, with modules in place of those of a robot's maker."""
    names: dict[str, Any] = {"__name__": page}
    # dataclasses look up the module that they are defined in
    for name, module in {**modules, page: ModuleType(page)}.items():
        patch.setitem(sys.modules, name, module)
    for block in re.findall(r"```python\n(.*?)```", (PAGES / f"{page}.md").read_text(encoding="utf-8"), flags=re.S):
        exec(compile(block, f"docs/robots/{page}.md", "exec"), names)
    return names


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    """A world whose time passes only where somebody waits."""
    made = World(POSES, LEVERS_M)

    def wait(seconds: float) -> None:
        made.clock_s += seconds

    monkeypatch.setattr(time, "sleep", wait)
    monkeypatch.setattr(time, "monotonic", lambda: made.clock_s)
    return made


@pytest.fixture
def kinova(world: World, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    return defined("kinova", kortex(), monkeypatch)


@pytest.fixture
def ros2(world: World, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    return defined("ros2", ros(), monkeypatch)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


def lab(names: dict[str, Any]) -> Any:
    force = names["ForceCalibration"](NEWTON_PER_AMPERE)
    return names["Lab"](POSES, LEVERS_M, width_mm=60.0, area_mm2=1500.0, force=force)


def kinova_robot(names: dict[str, Any], world: World) -> Any:
    base, cyclic = names["BaseClient"](world), names["BaseCyclicClient"](world)
    return names["KinovaRobot"](names["Gen3"](base, cyclic, lab(names)), lab(names))


def picture(image: np.ndarray) -> Label:
    return Label("mug" if image[..., 0].mean() > image[..., 2].mean() else "box")


def ros_robot(names: dict[str, Any], node: Node) -> Any:
    cell = names["Cell"](tuple(JOINTS), POSES, {JOINTS[joint]: lever for joint, lever in LEVERS_M.items()})
    return names["RosRobot"](names["RosArm"](node, cell), cell, picture)


def recorded(robot: Any, store: Store, folder: Path) -> RecordedRobot:
    return RecordedRobot(
        robot, NETWORK, store, thing=ThingRef("our lab", "box"), setup=Setup(), spool=Spool(folder, sync=False)
    )


def test_the_kinova_example_weighs_and_squeezes(
    kinova: dict[str, Any], world: World, store: Store, tmp_path: Path
) -> None:
    """Mass and modulus of the stand-in's object are found, and the signals are in the recordings."""
    robot = recorded(kinova_robot(kinova, world), store, tmp_path / "spool")
    weighed = robot.perform("weighing")
    signals = signals_in(store.get(robot.end_step() or ""))
    assert isinstance(weighed, Reading)
    assert weighed.value == pytest.approx(250, abs=5)
    assert isinstance(signals, WeighSignals)
    assert signals.holds_something
    assert [hold.torque_nm.shape for hold in signals.holds] == [(50,), (50,)]
    squeezed = robot.perform("squeezing")
    assert isinstance(squeezed, Reading)
    assert squeezed.value == pytest.approx(1e3 * world.newton_per_mm * 60 / 1500, rel=0.03)
    assert isinstance(signals_in(store.get(robot.end_step() or "")), SqueezeSignals)


def test_the_kinova_example_explores(
    kinova: dict[str, Any], world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page's exploration takes both actions and keeps an episode with their recordings."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PALPATE_SPOOL", str(tmp_path / "spool"))
    Path("setup.toml").write_text('[arm]\nname = "kinova_gen3"\n', encoding="utf-8")
    episode = kinova["explore"](world, lab(kinova), "box")
    taken = [step for step in episode.steps if "action" in step.record]
    assert {step.record["action"] for step in taken} == {"weighing", "squeezing"}
    assert all("value" in step.record["outcome"] and step.recording for step in taken)


def test_the_ros_example_weighs_and_looks(ros2: dict[str, Any], world: World, store: Store, tmp_path: Path) -> None:
    """The mass is found, and the image is the one that was published, in red, green and blue."""
    image = np.random.default_rng(2).integers(0, 256, (12, 16, 3), dtype=np.uint8)
    node = Node(world, JOINTS, image)
    robot = recorded(ros_robot(ros2, node), store, tmp_path / "spool")
    weighed = robot.perform("weighing")
    assert isinstance(weighed, Reading)
    assert weighed.value == pytest.approx(250, abs=5)
    assert isinstance(signals_in(store.get(robot.end_step() or "")), WeighSignals)
    assert robot.perform("cat-vision") == picture(image)
    seen = signals_in(store.get(robot.end_step() or ""))
    assert isinstance(seen, ImageSignals)
    np.testing.assert_array_equal(seen.image, image)
    assert node.listeners == []


def test_what_goes_wrong_is_a_failed_step(kinova: dict[str, Any], ros2: dict[str, Any], world: World) -> None:
    """An arm that does not arrive, a driver without torques and a silent camera say what was wrong."""
    node = Node(world, JOINTS)
    examples = ros_robot(ros2, node), kinova_robot(kinova, world)
    assert "/camera/color/image_raw: 0 messages came in 10 s" in reason(examples[0], "cat-vision")
    node.has_effort = False
    assert "no effort" in reason(examples[0], "weighing")
    world.moves = False
    assert all("did not reach the pose 'above'" in reason(robot, "weighing") for robot in examples)


def reason(robot: Robot, action: str) -> str:
    outcome = attempt(robot, action)
    assert isinstance(outcome, Failed)
    return outcome.reason


class Recording:
    """Runs an example's actions as recordings, as they expect."""

    def __init__(self, robot: Any, spool: Spool) -> None:
        self.actions = robot.actions
        self.perform = record("example", thing=ThingRef("our lab", "box"), spool=spool)(robot.perform)


class TestKinovaExample(RobotContract):
    """The example keeps the contract of a robot."""

    network = NETWORK

    @pytest.fixture(autouse=True)
    def _example(self, kinova: dict[str, Any], world: World, tmp_path: Path) -> None:
        self.made = lambda: Recording(kinova_robot(kinova, world), Spool(tmp_path, sync=False))

    def make_robot(self) -> Any:
        return self.made()


class TestRosExample(RobotContract):
    """The example keeps the contract of a robot."""

    network = NETWORK

    @pytest.fixture(autouse=True)
    def _example(self, ros2: dict[str, Any], world: World, tmp_path: Path) -> None:
        node = Node(world, JOINTS, np.full((4, 4, 3), 7, np.uint8))
        self.made = lambda: Recording(ros_robot(ros2, node), Spool(tmp_path, sync=False))

    def make_robot(self) -> Any:
        return self.made()
