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
