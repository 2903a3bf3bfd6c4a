"""`palpate calibrate`: sensor models from known objects, with what they were made from."""

from pathlib import Path
from typing import Any

import pytest

from palpate.network.reading import load_network, read_document
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.robots.sampled import SampledRobot
from palpate.store.opening import open_store
from tests.fitting.made_up import drawn, fill, network_of

BIASED = """
format = "palpate-network/1"
extends = "household-filled"
[actions.weighing.sensor]
property = "mass"
kind = "normal"
sd = 2
bias = 30
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a network whose scale reads 30 g too much."""
    (tmp_path / "biased.toml").write_text(BIASED, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def sampled(*more: object) -> tuple[object, ...]:
    return ("calibrate", "--like", "household", "-o", "own.toml", "--robot", "sampled", "--workers", 1, *more)


def test_a_bias_is_measured_and_written(run: Any, folder: Path) -> None:
    """What the robot is like comes into the file with counts, scores on held-out objects and provenance."""
    done = run(*sampled("--world", "biased.toml", "--action", "weighing", "--times", 4, "--folds", 4, "--seed", 3))
    assert done.code == 0
    for part in ("17, 68", "better by", "which its bias takes off", "own.toml: written"):
        assert part in done.out
    sensor = load_network("own.toml").actions["weighing"].sensor
    assert isinstance(sensor, NumberSensor)
    assert sensor.bias == pytest.approx(30, abs=4.5 * 2 / 68**0.5)
    assert sensor.sd == pytest.approx(2, rel=4.5 / (2 * 68) ** 0.5)
    tables = read_document("own.toml").tables
    assert tables["source"] == "Sensors fitted to 17 objects; [provenance] says how"
    provenance: Any = tables["provenance"]
    assert provenance["command"] == (
        "palpate calibrate --like household --robot sampled --world biased.toml --times 4 --seed 3 --pseudo-count "
        "0.2 --action weighing --output own.toml"
    )
    assert provenance["data"][0]["items"] == 68
    score = provenance["held_out"]["action"]["weighing"]
    assert score["better_by"] > 4 * score["se"] > 0
    assert (score["objects"], score["than"]) == (17, "template")
    own, before = (load_network(name).actions["squeezing"].sensor for name in ("own.toml", "household"))
    assert vars(own) == vars(before)


def test_labels_are_counted(run: Any, folder: Path) -> None:
    """A confusion matrix is smoothed and stands beside its counts; only objects that were named were measured."""
    run(*sampled("--action", "mat-sound", "--object", "ceramic_mug", "--object", "wooden_box_ycb", "--times", 6,
                 "--folds", 0))  # fmt: skip
    sensor: Any = read_document("own.toml").tables["actions"]["mat-sound"]["sensor"]  # type: ignore[index]
    counts = {state: sum(row) for state, row in sensor["counts"].items()}
    assert {state: count for state, count in counts.items() if count} == {"ceramic": 6, "wood": 6}
    found = load_network("own.toml").actions["mat-sound"].sensor
    assert isinstance(found, ConfusionSensor)
    ceramic = [(count + 0.2) / (6 + 8 * 0.2) for count in sensor["counts"]["ceramic"]]
    assert found.table[:, 0] == pytest.approx(ceramic, abs=1e-6)


def test_outcomes_are_kept(run: Any, folder: Path) -> None:
    """They are not measured again with --resume, and not overwritten without it; other settings are other outcomes."""
    command = sampled("--action", "weighing", "--times", 3, "--folds", 0)
    assert run(*command).code == 0
    first = (folder / "own.toml").read_text()
    assert "--resume" in run(*command, "--force").refused
    assert "exists already" in run(*command, "--resume").refused
    assert run(*command, "--resume", "--force").code == 0
    assert (folder / "own.toml").read_text() == first
    assert "of other settings" in run(*command, "--resume", "--force", "--seed", 4).refused
    assert run(*command, "--outcomes", "elsewhere", "--force").code == 0


def test_what_is_interrupted_is_kept(run: Any, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C ends with how much is done, where it is and how to go on; and so it does."""
    command = sampled("--action", "weighing", "--times", 3, "--folds", 0, "--workers", 1)
    perform, done = SampledRobot.perform, list[str]()

    def interrupted(robot: SampledRobot, action: str) -> Any:
        done.append(action)
        if len(done) > 7:
            raise KeyboardInterrupt
        return perform(robot, action)

    with monkeypatch.context() as patched:
        patched.setattr(SampledRobot, "perform", interrupted)
        ran = run(*command)
    assert (ran.code, ran.err) == (130, "palpate: interrupted\n")
    told = "Interrupted: 2 of 17 tasks are done and kept in own-outcomes; the same command with --resume goes on"
    assert told in " ".join(ran.out.split())
    assert not (folder / "own.toml").exists()
    assert run(*command, "--resume").code == 0


def test_the_bench_can_be_calibrated(run: Any, folder: Path) -> None:
    """The robot in physics weighs three objects; what it is off by is within the aim for the bench."""
    things = [word for name in ("ceramic_mug", "banana", "wineglass") for word in ("--object", name)]
    done = run("calibrate", "--like", "household", "-o", "own.toml", "--robot", "mujoco", "--workers", 1,
               "--action", "weighing", "--times", 2, "--folds", 3, *things)  # fmt: skip
    assert done.code == 0
    sensor = load_network("own.toml").actions["weighing"].sensor
    assert isinstance(sensor, NumberSensor)
    assert sensor.sd < 6
    assert abs(sensor.bias) < 6


def test_recordings_of_a_store(run: Any, folder: Path) -> None:
    """Recordings stand in for the robot; properties stay as they are."""
    network = network_of(folder)
    with open_store(folder / "lab.sqlite", durable=False) as store:
        fill(store, network, drawn(network, 30, 1))
    done = run("calibrate", "--like", "workshop.toml", "-o", "own.toml", "--store", "lab.sqlite", "--folds", 3)
    assert done.code == 0
    assert "30, 60" in done.out
    tables: Any = read_document("own.toml").tables
    assert "counts" not in tables["properties"]["kind"]
    assert "counts" in tables["actions"]["look"]["sensor"]
    assert "--store lab.sqlite" in tables["provenance"]["command"]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (("--robot", "sampled", "--store", "lab.sqlite"), "--store: for a store alone, and --robot was found"),
        (("--robot", "sampled", "--gripper", "2F-85"), "--gripper: for a store alone"),
        (("--robot", "mujoco", "--world", "household"), "--world: for the sampled robot alone"),
        (("--store", "lab.sqlite", "--object", "banana"), "for a robot alone"),
        (("--robot", "sampled", "--object", "bananna"), "did you mean 'banana'?"),
        (("--robot", "sampled", "--action", "weighting"), "did you mean 'weighing'?"),
        (("--store", "nowhere.sqlite"), "nowhere.sqlite"),
    ],
)
def test_bad_input_is_one_sentence(run: Any, folder: Path, more: tuple[str, ...], message: str) -> None:
    """Nothing is measured or written."""
    assert message in run("calibrate", "--like", "household", "-o", "own.toml", *more).refused
    assert {path.name for path in folder.iterdir()} == {"biased.toml"}


def test_an_output_that_cannot_be_written_is_refused_first(run: Any, folder: Path) -> None:
    """Before anything is measured."""
    assert (
        "the folder nowhere does not exist"
        in run("calibrate", "--like", "household", "-o", "nowhere/own.toml", "--robot", "sampled").refused
    )
