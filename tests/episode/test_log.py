import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.episode import About, EpisodeLog, read_episode, record_episode
from palpate.errors import LogError
from palpate.explore import Step, explore
from palpate.inference.exact import ExactBelief
from palpate.network.reading import load_network
from palpate.outcomes import Failed
from palpate.robots.replay import ReplayRobot
from palpate.robots.session import shipped_session
from palpate.selection.objectives import Learn
from palpate.selection.stopping import NothingLeft

ABOUT = About(
    "material", "greedy", "nothing left", "replay", "banana_ycb", 7, False, {"weighing": 15.0}, "exact (other)"
)


@pytest.fixture(scope="module")
def prior() -> Any:
    return ExactBelief(load_network("household"))


@pytest.fixture(scope="module")
def steps(prior: ExactBelief) -> Any:
    robot = ReplayRobot(shipped_session("banana_ycb").recorded)
    return list(explore(prior, robot, objective=Learn("material"), stopping=NothingLeft()))


@pytest.fixture
def path(prior: ExactBelief, steps: list[Step], tmp_path: Path) -> Any:
    log = EpisodeLog(tmp_path / "episode.jsonl", prior, ABOUT)
    for step in steps:
        log.write(step)
    return tmp_path / "episode.jsonl"


def test_a_log_holds_the_episode(path: Path, prior: ExactBelief, steps: list[Step]) -> None:
    """What is read back is what happened: setup, actions, outcomes, gains, costs and the reason."""
    episode = read_episode(path)
    assert episode.about == ABOUT
    assert episode.network == "household"
    assert episode.stop == steps[-1].stop
    assert len(episode.steps) == len(steps) - 1
    for logged, step in zip(episode.steps, steps, strict=False):
        assert (logged.action, logged.outcome, logged.notices) == (step.action, step.outcome, step.notices)
        assert logged.gains_bits == step.gains_bits
        assert logged.realised_gain_bits == step.realised_gain_bits
        assert (logged.cost_s, logged.total_cost_s, logged.surprise) == (step.cost_s, step.total_cost_s, step.surprise)


def test_a_log_is_enough_to_draw_beliefs(path: Path, steps: list[Step]) -> None:
    """Each step holds the belief before and after: probabilities, figures, and a curve with its area."""
    episode = read_episode(path)
    for logged, step in zip(episode.steps, steps, strict=False):
        material: Any = step.after.marginal("material")
        mass: Any = step.after.marginal("mass")
        states: Any = logged.after["material"]
        curve: Any = logged.after["mass"]
        assert list(states.probabilities.values()) == material.probabilities.tolist()
        assert curve.mean == mass.mean
        assert curve.quantiles["0.95"] == mass.quantile(0.95)
        assert np.trapezoid(curve.density, curve.x) == pytest.approx(1.0, abs=0.03)
    assert episode.steps[0].before == episode.prior
    assert episode.steps[1].before == episode.steps[0].after
    assert episode.posterior == episode.steps[-1].after


def test_a_log_replays(path: Path, prior: ExactBelief, steps: list[Step]) -> None:
    """A robot made from the log, or from the episode, leads to the same belief."""
    for robot in (ReplayRobot.read(path), ReplayRobot(read_episode(path).recorded)):
        again = list(explore(prior, robot, objective=Learn("material"), stopping=NothingLeft()))
        assert [step.action for step in again] == [step.action for step in steps]
        assert again[-1].after.probabilities("material") == pytest.approx(steps[-1].after.probabilities("material"))


def test_a_failed_step_keeps_its_reason(path: Path) -> None:
    """The failed squeeze of the banana is in the log with its reason."""
    squeeze = next(step for step in read_episode(path).steps if step.action == "squeezing")
    assert squeeze.outcome == Failed("the entry's mean is nan")
    assert squeeze.surprise is None


def test_an_episode_in_memory_is_the_one_in_the_file(path: Path, prior: ExactBelief, steps: list[Step]) -> None:
    """Recording in memory gives the same episode as writing and reading."""
    recorded, read = record_episode(prior, steps, ABOUT), read_episode(path)
    assert recorded.steps[-1].after == read.steps[-1].after
    assert recorded.recorded == read.recorded
    assert (recorded.digest, recorded.version, recorded.stop) == (read.digest, read.version, read.stop)


def test_every_line_is_json_that_any_program_reads(path: Path) -> None:
    """No line holds NaN or infinity, which JSON does not have."""

    def refuse(constant: Any) -> None:
        raise AssertionError(constant)

    for line in path.read_text().splitlines():
        json.loads(line, parse_constant=refuse)


def test_an_interrupted_log_is_readable(path: Path) -> None:
    """A log without its last line is an episode without a reason to stop."""
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:3]))
    episode = read_episode(path)
    assert len(episode.steps) == 2
    assert episode.stop is None


def test_each_step_is_in_the_file_as_soon_as_it_is_written(
    prior: ExactBelief, steps: list[Step], tmp_path: Path
) -> None:
    """A step is on disk when write returns, so that a crash loses nothing."""
    path = tmp_path / "episode.jsonl"
    log = EpisodeLog(path, prior)
    for number, step in enumerate(steps[:-1], 1):
        log.write(step)
        assert len(read_episode(path).steps) == number


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda rows: [*rows[:2], rows[2][:50]], "episode.jsonl line 3: the line is cut off"),
        (lambda rows: [rows[0][:50]], "episode.jsonl line 1: the line is cut off"),
        (lambda rows: [rows[0], rows[2]], "line 2: step 2 was found, expected step 1"),
        (lambda rows: [*rows, rows[1]], "a line was found after the one that says why exploration stopped"),
        (lambda rows: [rows[0], "3\n"], "line 2: int was found, expected a JSON object"),
        (lambda rows: [rows[0], rows[1].replace('"cost_s"', '"costs"')], "line 2: 'cost_s' is missing"),
        (lambda rows: [rows[0].replace("episode/1", "episode/2")], "expected 'palpate-episode/1'"),
        (lambda rows: [rows[0], rows[1].replace('"quantiles"', '"q"')], "incomplete: 'quantiles'"),
        (lambda rows: ["\n"], "is empty"),
    ],
)
def test_a_bad_log_names_the_line(path: Path, change: Any, told: str) -> None:
    """A log that is cut off or lacks something is a LogError that says where."""
    path.write_text("".join(change(path.read_text().splitlines(keepends=True))))
    with pytest.raises(LogError, match=re.escape(told)):
        read_episode(path)


def test_bytes_that_are_no_text_are_told(tmp_path: Path) -> None:
    """A binary file is a LogError and no decoding error."""
    (tmp_path / "picture").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(LogError, match="is not a text file in UTF-8"):
        read_episode(tmp_path / "picture")


def test_a_log_that_cannot_be_written_is_told_at_once(prior: ExactBelief, tmp_path: Path) -> None:
    """The file is opened before the exploration starts."""
    with pytest.raises(LogError, match="cannot be written: No such file or directory"):
        EpisodeLog(tmp_path / "missing" / "episode.jsonl", prior)
