from pathlib import Path

import numpy as np
import pytest

from palpate.episode import About, EpisodeLog, read_episode, record_episode
from palpate.explore import explore
from palpate.figures.episode import draw_episode
from palpate.inference.exact import ExactBelief
from palpate.network.reading import load_network
from palpate.robots.sampled import SampledRobot
from palpate.selection.stopping import StepBudget


def drawn(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Log of an exploration in which an action is repeated."""
    network = load_network("household")
    prior = ExactBelief(network)
    path = tmp_path_factory.mktemp("episode") / "episode.jsonl"
    costs_s = {name: action.cost_s for name, action in network.actions.items()}
    written = EpisodeLog(path, prior, About(objective="material", object="ceramic_mug", costs_s=costs_s))
    robot = SampledRobot(network, "ceramic_mug", np.random.default_rng(1))
    for step in explore(prior, robot, repeat=True, stopping=StepBudget(3)):
        written.write(step)
    return path


def test_the_log_alone_is_enough(log: Path, tmp_path: Path) -> None:
    """From a log come all names: object, objective, properties, states, actions and what they returned."""
    episode = read_episode(log)
    draw_episode(episode, tmp_path / "episode.svg")
    svg = drawn(tmp_path / "episode.svg")
    names = ["ceramic_mug", "gain on material", *episode.prior, *episode.about.costs_s, "wineglass", "soft-plastic"]
    assert all(f"<!-- {name}" in svg for name in names)
    for step in episode.steps:
        assert f"<!-- {step.index}. {step.action}" in svg


def test_drawing_is_repeatable(log: Path, tmp_path: Path) -> None:
    """The same log gives the same picture, byte for byte."""
    for name in ("a.png", "b.png"):
        draw_episode(read_episode(log), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_an_episode_without_steps_is_drawn(tmp_path: Path) -> None:
    """An exploration that stopped before its first step has a picture of the prior."""
    prior = ExactBelief(load_network("household"))
    draw_episode(record_episode(prior, []), tmp_path / "none.svg")
    assert "<!-- category" in drawn(tmp_path / "none.svg")
