import json
import re
from pathlib import Path
from typing import Any

import pytest

from palpate.errors import LogError
from palpate.network.admission import admit
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Posterior, Reading
from palpate.robots.session import Recording, Session, read_session, shipped_session, write_session

SESSION = Session(
    object="ball",
    source="invented",
    setup={"arm": "tentacle"},
    decisions=("the ball was round",),
    recordings=(
        Recording(
            "weighing_0",
            "weighing",
            Reading(12.0, unit="g"),
            ("grams are meant",),
            {"arm.load": (11.0, 13.0)},
            {"arm.load": "g"},
            {"object_pose": {"translation": [0.1, 0.2, 0.3]}},
            {"values": [{"mean": 12.0}]},
            {"camera.image": "ball.png (not there)"},
        ),
        Recording("squeezing_0", "squeezing", Failed("slipped")),
    ),
)


@pytest.fixture
def path(tmp_path: Path) -> Any:
    write_session(SESSION, tmp_path / "ball.jsonl")
    return tmp_path / "ball.jsonl"


def test_round_trip(path: Path) -> None:
    """A session that is written and read is the same, and nothing else is left in the folder."""
    session = read_session(path)
    assert session.recorded == SESSION.recorded
    assert session.all_decisions == ("the ball was round", "weighing_0: grams are meant")
    assert (session.object, session.source, session.setup) == ("ball", "invented", {"arm": "tentacle"})
    one = session.recordings[0]
    assert one.series == {"arm.load": [11.0, 13.0]}
    assert one.poses == {"object_pose": {"translation": [0.1, 0.2, 0.3]}}
    assert one.files == {"camera.image": "ball.png (not there)"}
    assert [entry.name for entry in path.parent.iterdir()] == ["ball.jsonl"]


def lines(path: Path) -> Any:
    return path.read_text().splitlines(keepends=True)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda rows: rows[:-1], "ball.jsonl is cut off after line 3: its last line must be an 'end'"),
        (lambda rows: rows[:1], "is cut off after line 1"),
        (lambda rows: [*rows[:1], *rows[2:]], "1 recordings were found, expected 2"),
        (lambda rows: [*rows[:2], rows[2][:20]], "ball.jsonl line 3: the line is cut off"),
        (lambda rows: [rows[0], "{nonsense}\n", *rows[2:]], "ball.jsonl line 2: column 2 is no JSON"),
        (
            lambda rows: [rows[0].replace("session/1", "session/9"), *rows[1:]],
            "line 1: the format is 'palpate-session/9'",
        ),
        (lambda rows: [rows[0].replace('"object"', '"thing"'), *rows[1:]], "line 1: 'object' is missing"),
        (lambda rows: [rows[0], rows[1].replace('"value"', '"valu"'), *rows[2:]], "line 2: 'outcome': no outcome"),
        (lambda rows: [], "is empty"),
    ],
)
def test_a_bad_file_names_the_line(path: Path, change: Any, told: str) -> None:
    """A file that is no whole session is a LogError that says where."""
    path.write_text("".join(change(lines(path))))
    with pytest.raises(LogError, match=re.escape(told)):
        read_session(path)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    """A missing file and a folder are LogErrors."""
    with pytest.raises(LogError, match="cannot be read: No such file"):
        read_session(tmp_path / "none.jsonl")
    with pytest.raises(LogError, match="cannot be read"):
        read_session(tmp_path)


def test_an_object_without_a_session_is_told() -> None:
    """Where no session ships the error lists those that do."""
    with pytest.raises(LogError, match="no recorded session of 'wineglass' ships: choose from 'banana_ycb'"):
        shipped_session("wineglass")


def test_the_shipped_session_holds_the_recorded_banana() -> None:
    """The shipped session has five recordings whose figures are those of the real one."""
    session = shipped_session("banana_ycb")
    outcomes: dict[str, Any] = {recording.action: recording.outcome for recording in session.recordings}
    assert list(outcomes) == ["cat-vision", "mat-vision", "mat-sound", "squeezing", "weighing"]
    assert outcomes["cat-vision"].probabilities["kettle"] == pytest.approx(0.576, abs=5e-4)
    assert isinstance(outcomes["squeezing"], Failed)
    assert outcomes["weighing"].value == pytest.approx(68.3, abs=0.05)
    assert outcomes["weighing"].unit == "g"
    for outcome in outcomes.values():
        if isinstance(outcome, Posterior):
            assert sum(outcome.probabilities.values()) == pytest.approx(1.0)
    by_name = {recording.name: recording for recording in session.recordings}
    assert len(by_name["elasticity_1"].series["robotiq_2f85.position"]) == 183
    assert by_name["density_0"].entry["values"][0]["mean"] == pytest.approx(253.98, abs=0.01)
    assert "10.1109/IROS58592.2024.10802249" in session.source


def test_the_shipped_session_is_admitted_by_its_network() -> None:
    """Every outcome of the shipped session fits the household network."""
    network = load_network("household")
    for action, outcome in shipped_session("banana_ycb").recorded:
        admit(network, action, outcome)


def test_no_path_of_another_computer_ships() -> None:
    """Names of files stay, folders of the computer they were recorded on do not."""
    text = json.dumps([dict(recording.files) for recording in shipped_session("banana_ycb").recordings])
    assert "img_cam1.png" in text
    assert "\\" not in text
    assert "/" not in text
