"""What is shown of a store and of one recording: in a terminal of 80 columns, in a pipe, and as JSON."""

import json
import re
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np
import pytest

from palpate.store.entries import Distribution, Value
from palpate.store.opening import open_store
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef
from tests.store.made_up import START, made_episode, squeeze

ODD = "the mean of the elasticity is no number at all, and so this is kept as a measurement that failed: " + "why " * 20
WHOLE = Recording(
    recorded_at=START,
    action="squeezing",
    thing=ThingRef("our lab", "sponge 3", "somebody", "kitchen sponge", {"colour": "yellow"}, ("sponge",)),
    setup=Setup(
        gripper=Device("gripper", "two_finger", "somebody", {"stroke_mm": 85}, {"offset_N": 0.5}, "2024-04-01"),
        camera=Device("camera", "eye"),
    ),
    owner="Doe, Jane",
    licence="CC-BY-4.0",
    ground_truth=True,
    software="0.1",
    repository="https://example.org/robot",
    grasp={"width_mm": 40},
    gripper_pose=Pose((0.1, 0.2, 0.3), (1.0, 0.0, 0.0, 0.0)),
    object_pose=Pose((0.4, 0.5, 0.6), frame="table"),
    series=(
        Series(
            "two_finger",
            (
                Channel("position", "length", "mm", np.linspace(60, 40, 150), rate_hz=100.0),
                Channel("force", "force", None, np.zeros((20, 3)), time_s=np.linspace(0, 1.5, 20)),
                Channel("current", "current", "A", np.zeros(150)),
            ),
        ),
    ),
    files=(FileItem("imgs/cam0.png", "image/png", b"1234"),),
    entries=(
        Value("elasticity", 42.0, 10.0, "kPa"),
        Distribution("material", {"foam": 0.6, "cloth": 0.2, "wood": 0.15, "glass": 0.05}),
    ),
    log="\n".join(f"line {number}" for number in range(30)),
    notices=(ODD,),
    id=UUID("abcdef01-0000-4000-8000-000000000001"),
)
TOLD = (
    "squeezing of kitchen sponge",
    "abcdef01-0000-4000-8000-000000000001",
    WHOLE.digest,
    "2024-05-01 12:00:00",
    "our lab/sponge 3 (called kitchen sponge; maker somebody; aliases sponge; colour yellow)",
    "ground truth yes",
    "Doe, Jane",
    "CC-BY-4.0",
    "the owner",
    "https://example.org/robot",
    "width_mm 40",
    "elasticity 42.0 ± 10.0 kPa",
    "material foam 0.60, cloth 0.20, wood 0.15, glass 0.050",
    "two_finger position length mm 150 100 Hz",
    "two_finger force force not stated 20 x 3 stamps, 0 to 1.50 s",
    "two_finger current current A 150 not known",
    "imgs/cam0.png image/png 4",
    "gripper two_finger somebody stroke_mm 85 2024-04-01 offset_N 0.5",
    "camera eye",
    "gripper 0.1, 0.2, 0.3 1, 0, 0, 0 base",
    "object 0.4, 0.5, 0.6 not known table",
    "line 19",
    "and 10 more lines (--json has them all)",
)


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store with a recording that has everything, and more whose ids begin alike."""
    path = tmp_path / "store.sqlite"
    monkeypatch.setenv("PALPATE_STORE", str(path))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    with open_store(path) as store:
        store.put(WHOLE)
        store.put(squeeze(1, id=UUID("12345678-9000-4000-8000-000000000001")))
        store.put(squeeze(2, id=UUID("12345678-9a00-4000-8000-000000000002")))
    return path


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch, run: Any) -> Any:
    """Run a command as in a terminal of 80 columns, and give the lines that it prints."""
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TTY_COMPATIBLE", "1")
    monkeypatch.setenv("TERM", "xterm")

    def lines(*arguments: object) -> list[str]:
        ran = run(*arguments)
        assert (ran.code, ran.err) == (0, "")
        return re.sub(r"\x1b\[[0-9;]*m", "", ran.out).splitlines()

    return lines


def test_one_recording_is_told_whole_in_a_pipe(run: Any, place: Path) -> None:
    """Each fact is there, and each is on one line whatever its length."""
    lines = [" ".join(line.split()) for line in run("store", "show", "abcdef01").out.splitlines()]
    for told in TOLD:
        assert [line for line in lines if told in line], told
    assert f"- {ODD.strip()}" in lines


def test_one_recording_fits_a_terminal(terminal: Any, place: Path) -> None:
    """In 80 columns nothing is cut off: the same words are there, folded."""
    lines = terminal("store", "show", "abcdef01")
    assert max(map(len, lines)) <= 80
    letters = "".join("".join(lines).split())
    for told in (WHOLE.digest, ODD, "https://example.org/robot"):
        assert "".join(told.split()) in letters


@pytest.fixture
def well_told(place: Path) -> None:
    """A recording with a device that has many parameters."""
    arm = Device("arm", "gen3", "palpate", {f"joint_{number:02}_limit_nm": 39.0 for number in range(30)})
    with open_store(place) as store:
        store.put(squeeze(3, id=UUID("99999999-0000-4000-8000-000000000003"), setup=Setup(arm=arm)))


def test_a_device_with_much_to_tell_fills_a_terminal(terminal: Any, well_told: None) -> None:
    """In 80 columns it has the whole width and not a column of words."""
    lines = terminal("store", "show", "99999999")
    assert max(map(len, lines)) <= 80
    start = lines.index("arm  gen3 by palpate") + 1
    told = [line.rstrip() for line in lines[start : start + 10]]
    assert min(map(len, told)) > 50
    assert " ".join(" ".join(told).split()).startswith("joint_00_limit_nm 39.0, joint_01_limit_nm 39.0, joint_02")


def test_a_device_with_much_to_tell_is_a_line_in_a_pipe(run: Any, well_told: None) -> None:
    """For programs that read lines."""
    (row,) = [line for line in run("store", "show", "99999999").out.splitlines() if line.startswith("arm ")]
    assert "joint_00_limit_nm 39.0" in row
    assert "joint_29_limit_nm 39.0" in row


def test_one_recording_as_json_is_json(run: Any, terminal: Any, place: Path) -> None:
    """It can be read by a program, in a pipe and from a terminal of 80 columns."""
    found = json.loads(run("store", "show", WHOLE.id, "--json").out)
    assert (found["digest"], found["notices"], found["log"]) == (WHOLE.digest, [ODD], WHOLE.log)
    assert found["thing"]["attributes"] == {"colour": "yellow"}
    assert json.loads("\n".join(terminal("store", "show", WHOLE.id, "--json"))) == found
    assert "--json: is for one recording" in run("store", "show", "--json").refused


def test_the_beginning_of_an_id_or_a_digest_is_enough(run: Any, place: Path) -> None:
    """As long as one recording begins so; several are listed, and another text is refused."""
    for key in (WHOLE.id, str(WHOLE.id).upper(), "a", "abcdef01-00", WHOLE.digest, WHOLE.digest[:9]):
        assert json.loads(run("store", "show", key, "--json").out)["digest"] == WHOLE.digest
    several = run("store", "show", "12345678-9").refused
    assert (
        "recording 12345678-9: 2 begin so; choose from '12345678-9000-4000-8000-000000000001', '12345678-9a00"
        in several
    )
    assert "'mug': is not the beginning of an id or a digest" in run("store", "show", "mug").refused
    assert "is not the beginning" in run("store", "show", "0" * 65).refused
    assert "recording 00ff: is not in the store" in run("store", "show", "00ff").refused


def test_many_that_begin_alike_are_not_all_listed(run: Any, place: Path) -> None:
    """Five are named, and that there are more is said."""
    with open_store(place) as store:
        store.put_many(squeeze(number, id=UUID(f"77777777-0000-4000-8000-{number:012}")) for number in range(10, 20))
    assert "more than 5 begin so" in run("store", "show", "7777").refused


def test_ids_in_a_terminal_are_short(terminal: Any, run: Any, place: Path) -> None:
    """Each is as long as it takes to be the only one on the page, and leads to its recording; --wide has them whole."""
    for command in (("store", "list"), ("store", "show")):
        lines = terminal(*command)
        assert max(map(len, lines)) <= 80
        found = [line.split()[0] for line in lines if "2024-05-01" in line]
        assert found == ["12345678-9a", "12345678-90", "abcdef01-00"]
        wide = " ".join(terminal(*command, "--wide")).split()
        assert {str(WHOLE.id), "12345678-9a00-4000-8000-000000000002"} <= set(wide)
    assert run("store", "show", "12345678-9a").code == 0


def test_ids_in_a_pipe_are_whole(run: Any, place: Path) -> None:
    """What a program reads has ids that hold for ever, and a row is a line."""
    lines = [line for line in run("store", "list").out.splitlines() if "squeezing" in line]
    assert [len(line.split()[0]) for line in lines] == [36, 36, 36]
    assert "elasticity 42.0 ± 10.0 kPa; material foam 0.60, cloth 0.20, ..." in lines[2]


def test_a_setup_is_found_by_the_beginning_of_its_digest(terminal: Any, run: Any, place: Path) -> None:
    """What the overview shows of a setup selects its recordings."""
    (shown,) = [line.split()[0] for line in terminal("store", "show") if "camera eye" in line]
    (row,) = json.loads(run("store", "list", "--setup", shown, "--json").out)["recordings"]
    assert row["id"] == str(WHOLE.id)
    assert "setup 'mug': is not the beginning of a digest" in run("store", "list", "--setup", "mug").refused


def test_an_episode_is_found_by_its_beginning(terminal: Any, run: Any, place: Path) -> None:
    """The list of episodes fits a terminal, and what it shows leads to the episode."""
    with open_store(place) as store:
        from palpate.store.keeping_episodes import put_episode

        receipt = put_episode(store, made_episode(WHOLE, stop="nothing left"))
    lines = terminal("store", "episodes")
    assert max(map(len, lines)) <= 80
    shown = lines[1].split()[0]
    assert len(shown) == 8
    assert json.loads(run("store", "episode", shown, "--json").out)["id"] == str(receipt.id)
    assert json.loads(run("store", "episode", receipt.digest[:12], "--json").out)["id"] == str(receipt.id)
    assert "'mug': is not the beginning" in run("store", "episode", "mug").refused
