import json
from pathlib import Path
from typing import Any

import pytest

from palpate.errors import EvidenceError, LogError
from palpate.outcomes import Label, Outcome, Reading
from palpate.robots.contract import RobotContract
from palpate.robots.replay import ReplayRobot
from palpate.robots.session import Recording, Session, write_session

RECORDED: list[tuple[str, Outcome]] = [("weigh", Reading(66.0)), ("look", Label("fruit")), ("weigh", Reading(67.0))]


class TestReplayRobot(RobotContract):
    """A robot that replays keeps the contract."""

    def make_robot(self) -> Any:
        return ReplayRobot(RECORDED)


def test_outcomes_come_in_recorded_order_of_each_action() -> None:
    """Each action gives its outcomes in the order of recording, whatever the order of asking."""
    robot = ReplayRobot(RECORDED)
    assert robot.actions() == ("weigh", "look")
    assert robot.perform("look") == Label("fruit")
    assert robot.actions() == ("weigh",)
    assert [robot.perform("weigh"), robot.perform("weigh")] == [Reading(66.0), Reading(67.0)]
    assert robot.actions() == ()


def test_nothing_is_invented() -> None:
    """An action of which nothing is left is an error that names what is."""
    with pytest.raises(
        EvidenceError, match="no recorded outcome of action 'knock' is left: choose from 'weigh', 'look'"
    ):
        ReplayRobot(RECORDED).perform("knock")


def test_a_session_file_is_replayed(tmp_path: Path) -> None:
    """A robot made from a session file gives the session's outcomes."""
    recordings = tuple(Recording(f"r{i}", action, outcome) for i, (action, outcome) in enumerate(RECORDED))
    write_session(Session("ball", "invented", recordings), tmp_path / "session.jsonl")
    robot = ReplayRobot.read(tmp_path / "session.jsonl")
    assert [robot.perform(action) for action, _ in RECORDED] == [outcome for _, outcome in RECORDED]


def test_a_bad_outcome_in_a_file_names_the_line(tmp_path: Path) -> None:
    """What cannot be read in a file is a LogError with file and line."""
    path = tmp_path / "bad.jsonl"
    path.write_text(
        json.dumps({"format": "palpate-session/1"}) + "\n" + json.dumps({"outcome": {"action": "x"}}) + "\n"
    )
    with pytest.raises(LogError, match=r"bad\.jsonl line 2: 'outcome': no outcome of action 'x'"):
        ReplayRobot.read(path)
