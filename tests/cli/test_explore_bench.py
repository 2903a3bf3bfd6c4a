import json
import os
import re
import subprocess
import sys
from ctypes.util import find_library
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from uuid import UUID

import pytest

# asked without importing it: the bench says what MuJoCo draws with before it is imported
if find_spec("mujoco") is None:
    pytest.skip("the bench needs MuJoCo", allow_module_level=True)

from palpate.episode import read_episode
from palpate.network.reading import load_network
from palpate.network.sensors import NumberSensor
from palpate.recording import Spool
from palpate.robots.mujoco import camera
from palpate.robots.mujoco.estimates import estimates
from palpate.robots.mujoco.reading import SHIPPED
from palpate.robots.recorded_signals import estimated_again
from palpate.store.opening import open_store
from palpate.summary import ContinuousSummary

pytestmark = pytest.mark.usefixtures("drawing")

BENCH = ("--robot", "mujoco", "--seed", 1)


@pytest.fixture(autouse=True)
def _spool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PALPATE_SPOOL", str(tmp_path / "spool"))


def test_the_sponges_are_told_apart(run: Any, tmp_path: Path) -> None:
    """The soft and the stiff sponge, which look alike, are squeezed, and what is believed is near the truth."""
    means = {}
    for thing in ("soft_yellow_sponge", "stiff_yellow_sponge"):
        log = tmp_path / f"{thing}.jsonl"
        ran = run("explore", thing, *BENCH, "--learn", "elasticity", "--log", log)
        assert ran.code == 0, ran.err
        episode = read_episode(log)
        assert (episode.about.robot, episode.network) == ("mujoco", "household-filled")
        assert "squeezing" in [step.action for step in episode.steps]
        believed = episode.posterior["elasticity"]
        assert isinstance(believed, ContinuousSummary)
        means[thing] = believed.mean or 0.0
    assert means["soft_yellow_sponge"] == pytest.approx(8, abs=3)
    assert means["stiff_yellow_sponge"] > means["soft_yellow_sponge"] + 5


def test_an_exploration_is_recorded_with_all_signals(run: Any, tmp_path: Path) -> None:
    """Each action is a recording, marked as simulated with the seed; show and curves show its signals."""
    store, log = tmp_path / "store.sqlite", tmp_path / "log.jsonl"
    kept = ("--store", store)
    arguments = ("--policy", "fixed:weighing,squeezing", "--stop", "nothing-left", "--log", log, "--record", *kept)
    ran = run("explore", "banana_ycb", *BENCH, *arguments)
    assert ran.code == 0, ran.err
    assert Spool().waiting() == []
    listed = json.loads(run("store", "list", *kept, "--format", "json").out)["recordings"]
    assert {row["action"] for row in listed} == {"weighing", "squeezing"}
    outcomes = {step.action: step.outcome for step in read_episode(log).steps}
    with open_store(store) as found:
        own = estimates(load_network("household-filled"))
        for row in listed:
            recording = found.get(UUID(row["id"]))
            assert (recording.thing.dataset, recording.thing.id) == ("simulated-bench", "banana_ycb")
            assert recording.notices == ("simulated on the bench in physics with seed 1, not measured",)
            assert re.search(r"palpate .*, MuJoCo \d", recording.software or "")
            assert estimated_again(recording, own) == outcomes[recording.action]
    shown = run("store", "show", *kept)
    assert "simulated_gen3" in shown.out.replace("\n", "")
    curves = run("store", "curves", *kept, "--gripper", "simulated_2f85", "--output", tmp_path / "curves.npz")
    # seven torques and angles, seven torques of the empty arm, and the gripper in both actions
    assert f"{7 + 7 + 7 + 4 + 4} channels" in curves.out


def test_sensors_are_calibrated_from_what_the_bench_recorded(run: Any, tmp_path: Path) -> None:
    """The store knows what is true of simulated objects, so recordings made on the bench are enough."""
    store, network = ("--store", tmp_path / "store.sqlite"), tmp_path / "own.toml"
    weighing = ("--policy", "fixed:weighing", "--repeat", "--steps", 2, "--record")
    for thing in ("ceramic_mug", "banana_ycb", "wineglass"):
        ran = run("explore", thing, *BENCH, *weighing, *store)
        assert ran.code == 0, ran.err
    shown = run("store", "object", "show", "banana_ycb", *store).out
    assert "looks_like: banana" in shown
    assert re.search(r"mass\s+66\.0 g\s+the simulation", shown)
    ran = run("calibrate", "--like", "household", *store, "-o", network, "--folds", 0)
    assert ran.code == 0, ran.err
    sensor = load_network(network).actions["weighing"].sensor
    assert isinstance(sensor, NumberSensor)
    assert sensor.sd < 6


def test_own_objects_have_their_own_shapes(run: Any, tmp_path: Path) -> None:
    """A file of shapes takes the place of the one that ships, and is named where it lacks the object."""
    text = SHIPPED.read_text(encoding="utf-8")
    shapes, log = tmp_path / "shapes.toml", tmp_path / "log.jsonl"
    shapes.write_text(text.replace("size_mm = [190, 36, 64]", "size_mm = [150, 36, 64]"), encoding="utf-8")
    arguments = ("--policy", "fixed:weighing", "--steps", 1, "--log", log, "--shapes", shapes)
    ran = run("explore", "banana", *BENCH, *arguments)
    assert ran.code == 0, ran.err
    assert read_episode(log).steps[0].outcome.value == pytest.approx(120, abs=20)  # type: ignore[union-attr]
    shapes.write_text(text.replace("objects.banana", "objects.melon"), encoding="utf-8")
    refused = run("explore", "banana", *BENCH, *arguments).refused
    assert f"{shapes}: no shape of object 'banana' was found: choose from" in refused


def test_noise_is_what_was_asked_for(run: Any, tmp_path: Path) -> None:
    """Without noise a weighing is right to a gram; a grasp that surely misses is a failed step."""
    log = tmp_path / "log.jsonl"
    weighing = ("--policy", "fixed:weighing", "--steps", 1, "--log", log)
    assert run("explore", "ceramic_mug", *BENCH, *weighing, "--noise", "none").code == 0
    assert read_episode(log).steps[0].outcome.value == pytest.approx(330, abs=1)  # type: ignore[union-attr]
    missed = ("--noise", "none", "--noise", "miss_probability=1")
    ran = run("explore", "ceramic_mug", *BENCH, *weighing, *missed)
    assert ran.code == 0
    assert "nothing is between the fingers" in " ".join(ran.out.split())


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("soft_yelow_sponge", *BENCH), r"unknown object 'soft_yelow_sponge' \(did you mean 'soft_yellow_sponge'\?\)"),
        (BENCH, "no OBJECT was found; choose from 'banana'"),
        (("banana", *BENCH, "--noise", "grasp_ofset_mm=1"), r"--noise: unknown name .* \(did you mean 'grasp_offset"),
        (
            ("ripe_avocado", "--network", "pantry", *BENCH),
            r"palpate: the bench's own objects: no shape of object 'ripe_avocado' was found: choose from 'banana', .*"
            r", or name a file that has its shape \(palpate explore --shapes FILE\)",
        ),
        (("banana", "--shapes", "own.toml"), "--shapes is only for --robot mujoco, and the robot is sampled"),
        (("banana", *BENCH, "--shapes", "nowhere.toml"), "nowhere.toml cannot be read as TOML"),
        (("banana", *BENCH, "--noise", "loud"), "--noise: 'loud' was found, expected NAME=VALUE or none"),
        (("banana", *BENCH, "--noise", "force_sd_n=-1"), "--noise force_sd_n: '-1' was found, expected a finite"),
        (("banana", *BENCH, "--noise", "slip_probability=2"), "slip_probability 2.0 was found, expected 0 to 1"),
        (("banana", *BENCH, "--session", "store"), "--session is only for --robot replay, and the robot is mujoco"),
        (("banana", *BENCH, "--timeout", "5"), "--timeout is not for --robot mujoco"),
        (("banana", "--noise", "none"), "--noise is only for --robot mujoco, and the robot is sampled"),
    ],
)
def test_what_cannot_be_asked_is_one_sentence(run: Any, arguments: tuple[object, ...], told: str) -> None:
    """Bad input is refused before anything moves."""
    assert re.search(told, run("explore", *arguments).refused)


def test_a_missing_package_is_named(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without MuJoCo the command says what to install."""
    from palpate.cli import benching

    monkeypatch.setattr(benching, "find_spec", lambda name: None)
    refused = run("explore", "banana", *BENCH).refused
    assert 'pip install "palpate[bench]" (in a clone: .venv/bin/pip install -e ".[bench]")' in refused


def test_the_graphics_are_let_go_of(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever comes of an exploration, the camera is closed."""
    closed: list[object] = []

    def close(own: object) -> None:
        closed.append(own)

    monkeypatch.setattr(camera.Camera, "close", close)
    assert run("explore", "banana", *BENCH, "--policy", "fixed:squeezing", "--steps", 1).code == 0
    assert len(closed) == 1
    monkeypatch.setattr(sys.modules["palpate.cli.exploring"], "_explore", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        run("explore", "banana", *BENCH)
    assert len(closed) == 2


def test_a_robot_that_looks_needs_a_way_to_draw(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing can be drawn, that is said before the first action, and what would help."""

    def broken(*_: object) -> None:
        raise RuntimeError("no library for it")

    monkeypatch.setattr(f"{estimates.__module__}.estimates", lambda network, path: {"cat-vision": broken})
    monkeypatch.setattr("mujoco.Renderer", broken)
    told = run("explore", "banana", *BENCH).refused
    assert "cannot draw here (no library for it): install Mesa's EGL or OSMesa" in told
    assert "only actions that look, --video and --rerun need it" in told


@pytest.mark.parametrize("library", ["disabled", "osmesa"])
def test_without_graphics_a_robot_that_does_not_look_explores(tmp_path: Path, library: str) -> None:
    """Where MuJoCo can draw nothing a fixed order without looking goes on; a library that is missing is named."""
    if library == "osmesa" and any(map(find_library, ("OSMesa", "libOSMesa"))):
        pytest.skip("OSMesa is installed")
    command = [sys.executable, "-m", "palpate", "explore", "banana", *map(str, BENCH), "--steps", "1", "--policy"]
    # set by MuJoCo where this process draws
    environment = {name: value for name, value in os.environ.items() if name != "PYOPENGL_PLATFORM"}
    environment["MUJOCO_GL"] = library

    def ran(policy: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*command, policy], env=environment, capture_output=True, text=True, check=False)

    weighed, looked = ran("fixed:weighing"), ran("fixed:cat-vision")
    assert looked.returncode == 2
    assert looked.stderr.count("\n") == 1
    if library == "disabled":
        assert (weighed.returncode, weighed.stderr) == (0, "")
        assert "cannot draw here (no graphics library was found): install Mesa's EGL" in looked.stderr
    else:
        assert "MuJoCo cannot be imported with MUJOCO_GL=osmesa" in looked.stderr
        assert looked.stderr == weighed.stderr
