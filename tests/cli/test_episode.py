import json
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def log(run: Any, tmp_path: Path) -> Path:
    path = tmp_path / "episode.jsonl"
    assert run("explore", "banana", "--steps", 2, "--seed", 1, "--log", path).code == 0
    return path


def test_a_truncated_log_is_refused(run: Any, log: Path, tmp_path: Path) -> None:
    """A log cut off within a line is refused with file and line, and no picture is made."""
    log.write_bytes(log.read_bytes()[:-20])
    refused = run("episode", "plot", log, tmp_path / "episode.png").refused
    assert "episode.jsonl" in refused
    assert "line 4" in refused
    assert not (tmp_path / "episode.png").exists()


def test_a_log_that_is_not_there_is_refused(run: Any, tmp_path: Path) -> None:
    """A missing log is refused by its name."""
    assert "none.jsonl" in run("episode", "plot", tmp_path / "none.jsonl", tmp_path / "episode.png").refused


def test_an_interrupted_episode_is_drawn(run: Any, log: Path, tmp_path: Path) -> None:
    """A log without its last line is of an interrupted exploration, and is drawn as far as it goes."""
    lines = log.read_text(encoding="utf-8").splitlines(keepends=True)
    for kept in (1, 2, 3):
        log.write_text("".join(lines[:kept]), encoding="utf-8")
        assert run("episode", "plot", log, tmp_path / f"{kept}.svg").code == 0
        assert "interrupted" in (tmp_path / f"{kept}.svg").read_text(encoding="utf-8")


def upload(folder: Path, name: str, **entry: Any) -> Path:
    """An upload dictionary of a teapot."""
    measurement = {
        "object_instance": {"common_name": "teapot"},
        "setup": {},
        "sensor_outputs": {},
        "object_pose": {},
        "gripper_pose": {},
    }
    path = folder / f"upload_dict_2001_01_01_00_00_00_{name}_0.json"
    path.write_text(json.dumps({"measurement": measurement, "entry": {"name": name, **entry}}), encoding="utf-8")
    return path


@pytest.fixture
def uploads(tmp_path: Path) -> list[Path]:
    folder = tmp_path / "uploads"
    folder.mkdir()
    labels = [{"name": "mug", "probability": 0.7}, {"name": "kettle", "probability": 0.3}]
    return [
        upload(folder, "elasticity", type="continuous", values=[{"mean": 42.0, "std": 1.0, "units": None}]),
        upload(folder, "cat-vision", type="categorical", values=labels),
    ]


def test_uploads_become_a_session_that_replays(run: Any, tmp_path: Path, uploads: list[Path]) -> None:
    """Converted files, or their folder, are one session, which explore replays."""
    session, again = tmp_path / "session.jsonl", tmp_path / "again.jsonl"
    ran = run("episode", "convert", *uploads, "-o", session, "--source", "invented")
    assert ran.code == 0, ran.err
    assert "2 recordings of teapot" in ran.out
    assert "squeezing: 42.0 kPa" in ran.out
    assert "--verbose" in ran.out
    assert run("episode", "convert", uploads[0].parent, "--output", again, "--source", "invented").code == 0
    assert session.read_bytes() == again.read_bytes()
    replayed = run("explore", "teapot", "--robot", "replay", "--session", session)
    assert replayed.code == 0, replayed.err
    assert "42.0 kPa" in replayed.out


def test_decisions_are_printed_when_asked_for(run: Any, tmp_path: Path, uploads: list[Path]) -> None:
    """--verbose prints each decision taken in reading the files; --labels takes the most probable label."""
    told = run("episode", "convert", *uploads, "-o", tmp_path / "session.jsonl", "--verbose").out
    assert "note: elasticity_0: the entry gives no unit: kPa is assumed" in told
    assert "'kettle' 0.3000" in told
    labels = run("episode", "convert", *uploads, "-o", tmp_path / "session.jsonl", "--labels").out
    assert "cat-vision: mug" in labels


def test_what_cannot_be_converted_is_refused(run: Any, tmp_path: Path, uploads: list[Path]) -> None:
    """A wrong file, network or place to write is one sentence, and no session is written."""
    session = tmp_path / "session.jsonl"
    uploads[0].write_text("{", encoding="utf-8")
    assert "elasticity_0.json" in run("episode", "convert", *uploads, "-o", session).refused
    assert "pantry" in run("episode", "convert", uploads[1], "-o", session, "--network", "pantri").refused
    assert "'sniff'" in run("episode", "convert", uploads[1], "-o", session, "--network", "pantry").refused
    assert "--output" in run("episode", "convert", uploads[1], "-o", tmp_path / "none" / "x.jsonl").refused
    assert not session.exists()
