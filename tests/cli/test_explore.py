import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from palpate.episode import read_episode
from palpate.network.reading import load_network
from palpate.robots.sampled import SampledRobot

NETWORK = load_network("household-filled")


def logged(path: Path) -> list[Any]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_list_names_every_object(run: Any) -> None:
    """--list shows every object of the network, and what the tricks look like."""
    listed = run("explore", "--list")
    assert listed.code == 0
    names = [line.split()[0] for line in listed.out.splitlines()[1:]]
    assert names == list(NETWORK.objects)


def test_every_step_is_shown(run: Any, tmp_path: Path) -> None:
    """The screen shows what the log holds: actions, outcomes, gains, surprise, every property and the reason."""
    log = tmp_path / "episode.jsonl"
    ran = run("explore", "wineglass_ycb", "--seed", 1, "--log", log)
    assert ran.code == 0
    episode = read_episode(log)
    assert len(episode.steps) > 1
    for step in episode.steps:
        assert f"Step {step.index}  {step.action}  returned  " in ran.out
        assert f"gain {step.expected_gain_bits:.3f} expected, {step.realised_gain_bits:.3f} realised" in ran.out
        for action, gain in step.gains_bits.items():
            assert re.search(rf"{action} +{gain:.3f}", ran.out)
    assert "Stopped" in ran.out
    assert str(episode.stop) in ran.out
    assert all(name in ran.out for name in NETWORK.properties)
    assert "surprise" in ran.out
    assert "\x1b" not in ran.out


def test_truth_is_scored(run: Any) -> None:
    """At the end every known property is found or not; a truth that is a stand-in is not scored."""
    ran = run("explore", "banana", "--seed", 1)
    verdicts = ran.out[ran.out.index("verdict") :].splitlines()[1:]
    assert [line.split()[0] for line in verdicts] == list(NETWORK.properties)
    known = NETWORK.object("banana").truth
    for line in verdicts:
        assert ("not scored" in line) == (not known[line.split()[0]].scored)


def test_the_same_seed_is_the_same_exploration(run: Any) -> None:
    """A seed fixes all chance, and the seed of an exploration without one is shown."""
    first, second = (run("explore", "ceramic_mug", "--seed", 5, "--policy", "random").out for _ in range(2))
    assert first == second
    assert re.search(r"seed \d+", run("explore", "ceramic_mug", "--steps", 1).out)


def test_a_log_can_be_replayed(run: Any, tmp_path: Path) -> None:
    """An episode log is a session: replaying it takes the same steps to the same belief."""
    log, again = tmp_path / "first.jsonl", tmp_path / "again.jsonl"
    assert run("explore", "white_tile", "--seed", 2, "--log", log).code == 0
    options = ["--robot", "replay", "--session", log, "--network", "household-filled", "--log", again]
    assert run("explore", *options).code == 0
    assert [line["action"] for line in logged(again)[1:-1]] == [line["action"] for line in logged(log)[1:-1]]
    assert logged(again)[-2]["belief"] == logged(log)[-2]["belief"]


def test_the_shipped_session_is_replayed(run: Any) -> None:
    """The banana session is replayed as it was recorded, and --verbose tells every decision."""
    arguments = ["explore", "banana_ycb", "--robot", "replay", "--stop", "nothing-left"]
    quiet, verbose = run(*arguments, "--seed", 1), run(*arguments, "--seed", 1, "--verbose")
    assert quiet.code == verbose.code == 0
    assert "squeezing  returned  failed" in quiet.out
    assert "68.3 g" in quiet.out
    assert "note: " not in quiet.out
    assert "--verbose" in quiet.out
    assert verbose.out.count("note: ") > 5
    assert "kettle" in verbose.out


def test_options_reach_the_exploration(run: Any, tmp_path: Path) -> None:
    """Objective, policy, rules and costs of the command line are those of the exploration and its log."""
    log = tmp_path / "episode.jsonl"
    arguments = ["--learn", "material", "--policy", "fixed:weighing,mat-sound", "--stop", "nothing-left"]
    assert run("explore", "ceramic_mug", *arguments, "--cost", "weighing=3", "--seed", 1, "--log", log).code == 0
    header, *steps, end = logged(log)
    assert [step["action"] for step in steps] == ["weighing", "mat-sound"]
    assert [step["total_cost_s"] for step in steps] == [3.0, 11.0]
    assert header["objective"] == "material"
    assert (header["policy"], header["stopping"], header["seed"]) == ("fixed:weighing,mat-sound", "nothing-left", 1)
    assert "policy" in end["stop"]


def test_budget_and_steps(run: Any, tmp_path: Path) -> None:
    """No action that exceeds the budget is taken, and no step beyond the number allowed."""
    log = tmp_path / "episode.jsonl"
    run("explore", "ceramic_mug", "--budget", 10, "--seed", 1, "--log", log)
    assert 0 < read_episode(log).steps[-1].total_cost_s <= 10
    run("explore", "ceramic_mug", "--steps", 2, "--stop", "nothing-left", "--repeat", "--seed", 1, "--log", log)
    assert len(read_episode(log).steps) == 2


def test_surprising_outcomes_are_marked(run: Any, tmp_path: Path) -> None:
    """A step whose surprise is below 0.01 is marked, and no other."""
    log = tmp_path / "episode.jsonl"
    log.write_text(SURPRISING, encoding="utf-8")
    ran = run("explore", "--robot", "replay", "--session", log, "--policy", "fixed:cat-vision,weighing")
    assert ran.code == 0, ran.err
    assert ran.out.count("surprising!") == 1
    assert "practically impossible" not in ran.out


@pytest.mark.parametrize("columns", ["80", "160"])
def test_practically_impossible_outcomes_are_told(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, columns: str
) -> None:
    """A step whose surprise is practically zero says what to suspect, as a weighing below zero."""
    monkeypatch.setenv("COLUMNS", columns)
    log = tmp_path / "episode.jsonl"
    log.write_text(SURPRISING.replace("2400.0", "-500.0"), encoding="utf-8")
    ran = run("explore", "--robot", "replay", "--session", log, "--policy", "fixed:cat-vision,weighing")
    words = " ".join(ran.out.split())
    assert words.count("practically impossible under this network: wrong sensor, wrong unit, or an object") == 1
    assert max(map(len, ran.out.splitlines())) <= int(columns)


def test_a_replay_has_a_seed_only_where_it_matters(run: Any, tmp_path: Path) -> None:
    """Nothing of a replay is by chance but a random policy: else no seed is shown or logged."""
    log = tmp_path / "episode.jsonl"
    for policy, seed in (("greedy", None), ("random", 4)):
        ran = run("explore", "banana_ycb", "--robot", "replay", "--policy", policy, "--seed", 4, "--log", log)
        assert ("seed" in ran.out) == (seed is not None)
        assert read_episode(log).about.seed == seed


SURPRISING = (
    "\n".join(
        json.dumps(line)
        for line in (
            {"format": "palpate-session/1", "object": "white_tile", "source": "invented", "setup": {}, "decisions": []},
            *(
                {
                    "name": item["action"],
                    "outcome": item,
                    "decisions": [],
                    "entry": {},
                    "poses": {},
                    "files": {},
                    "units": {},
                }
                | {"series": {}}
                for item in (
                    {"action": "cat-vision", "label": "mug"},
                    {"action": "weighing", "value": 2400.0, "unit": "g"},
                )
            ),
            {"end": 2},
        )
    )
    + "\n"
)


@pytest.mark.parametrize("columns", ["80", "120", "200"])
def test_no_line_is_wider_than_the_screen(run: Any, monkeypatch: pytest.MonkeyPatch, columns: str) -> None:
    """Tables fit 80 columns, and use more where there are more."""
    monkeypatch.setenv("COLUMNS", columns)
    ran = run("explore", "enamel_mug_ycb", "--seed", 1)
    assert max(map(len, ran.out.splitlines())) <= int(columns)
    assert "…" not in ran.out


def test_a_terminal_that_cannot_show_bars(tmp_path: Path) -> None:
    """Where the encoding lacks a character there is another one, and no error."""
    program = [sys.executable, "-m", "palpate", "explore", "banana", "--steps", "1", "--seed", "1"]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    found = subprocess.run(program, capture_output=True, text=True, check=True, env=environment)
    assert found.stdout.isascii()
    assert "Step 1" in found.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["bananna"], "(did you mean 'banana'?)"),
        (["banana", "--network", "hausehold"], "(did you mean 'household'?)"),
        (["banana", "--network", ""], "no such file"),
        (["banana", "--engine", "exakt"], "(did you mean 'exact'?)"),
        (["banana", "--learn", "materal"], "(did you mean 'material'?)"),
        (["banana", "--learn", ""], "--learn"),
        (["banana", "--cost", "wieghing=1"], "(did you mean 'weighing'?)"),
        (["banana", "--cost", "weighing=1", "--cost", "weighing=2"], "--cost weighing"),
        ([], "OBJECT"),
        (["banana", "--learn", "colour"], "--learn"),
        (["banana", "--policy", "wild"], "--policy"),
        (["banana", "--stop", "never"], "--stop"),
        (["banana", "--stop", "sd:material:1"], "material"),
        (["banana", "--stop", "entropy:mass:1"], "mass"),
        (["banana", "--cost", "kick=1"], "--cost"),
        (["banana", "--budget", "nan"], "--budget"),
        (["banana", "--budget", "-1"], "--budget"),
        (["banana", "--timeout", "0"], "--timeout"),
        (["banana", "--engine", "magic"], "--engine"),
        (["banana", "--network", "none.toml"], "none.toml"),
        (["banana", "--session", "x.jsonl"], "--robot replay"),
        (["ceramic_mug", "--robot", "replay"], "banana_ycb"),
        (["--robot", "replay", "--session", "none.jsonl"], "none.jsonl"),
    ],
)
def test_wrong_options_are_one_sentence(run: Any, tmp_path: Path, arguments: list[str], said: str) -> None:
    """What cannot be done is refused in one sentence before anything is done: nothing is printed, no file is made."""
    log, plot = tmp_path / "episode.jsonl", tmp_path / "episode.png"
    assert said in run("explore", *arguments, "--log", log, "--plot", plot).refused
    assert list(tmp_path.iterdir()) == []


def test_a_session_with_actions_of_another_network_is_refused(run: Any, tmp_path: Path) -> None:
    """A session is not replayed under a network that does not know its actions."""
    log = tmp_path / "session.jsonl"
    log.write_text(SURPRISING, encoding="utf-8")
    refused = run("explore", "--robot", "replay", "--session", log, "--network", "pantry").refused
    assert "robot ReplayRobot offers the unknown action 'cat-vision'" in refused
    assert "'sniff'" in refused


def test_a_session_of_another_object_is_refused(run: Any, tmp_path: Path) -> None:
    """A session is not scored against an object it is not of."""
    log = tmp_path / "session.jsonl"
    log.write_text(SURPRISING, encoding="utf-8")
    assert "white_tile" in run("explore", "banana", "--robot", "replay", "--session", log).refused


@pytest.mark.parametrize(
    ("option", "path"),
    [("--log", "none/x.jsonl"), ("--plot", "none/x.png"), ("--plot", "x.txt"), ("--log", "."), ("--plot", "x")],
)
def test_files_that_cannot_be_written_are_refused_first(run: Any, tmp_path: Path, option: str, path: str) -> None:
    """A log or picture that cannot be written is refused before exploration starts."""
    refused = run("explore", "banana", option, tmp_path / path).refused
    assert option in refused
    assert list(tmp_path.iterdir()) == []


def test_a_fault_while_exploring_leaves_a_readable_log(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When exploration is interrupted the log holds the steps that were done, and no picture is left behind."""
    original = SampledRobot.perform

    def interrupted(robot: SampledRobot, action: str) -> Any:
        if len(logged(tmp_path / "episode.jsonl")) > 1:
            raise KeyboardInterrupt
        return original(robot, action)

    monkeypatch.setattr(SampledRobot, "perform", interrupted)
    options = ["--log", tmp_path / "episode.jsonl", "--plot", tmp_path / "episode.png", "--seed", 1]
    assert run("explore", "banana", *options).code == 130
    episode = read_episode(tmp_path / "episode.jsonl")
    assert len(episode.steps) == 1
    assert episode.stop is None
    assert [path.name for path in tmp_path.iterdir()] == ["episode.jsonl"]


def test_plot(run: Any, tmp_path: Path) -> None:
    """--plot draws the episode; the same picture comes from the log alone."""
    log, plot, again = (tmp_path / name for name in ("episode.jsonl", "episode.png", "again.png"))
    assert run("explore", "banana", "--seed", 1, "--log", log, "--plot", plot).code == 0
    assert run("episode", "plot", log, again).code == 0
    assert plot.read_bytes()[:4] == b"\x89PNG"
    assert plot.read_bytes() == again.read_bytes()


def test_an_error_while_exploring_loses_nothing(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot that comes to offer an action nobody knows is one sentence; what was done is in the log, to be drawn."""
    log = tmp_path / "episode.jsonl"
    original = SampledRobot.actions

    def changing(robot: SampledRobot) -> tuple[str, ...]:
        done = len(logged(log)) - 1 if log.exists() else 0
        return (*original(robot), "juggling") if done == 2 else original(robot)

    monkeypatch.setattr(SampledRobot, "actions", changing)
    ran = run("explore", "banana", "--log", log, "--seed", 1)
    assert ran.code == 2
    assert ran.err.startswith("palpate: robot SampledRobot offers the unknown action 'juggling': choose from ")
    assert ran.err.count("\n") == 1
    episode = read_episode(log)
    assert (len(episode.steps), episode.stop) == (2, None)
    assert run("episode", "plot", log, tmp_path / "episode.svg").code == 0


def test_a_screen_that_is_gone_loses_nothing(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A step is in the log before it is shown, so that a closed pipe does not lose it."""
    log = tmp_path / "episode.jsonl"

    def closed(*_: object) -> None:
        raise BrokenPipeError(32, "Broken pipe")

    monkeypatch.setattr("palpate.cli.step_view.View.step", closed)
    ran = run("explore", "banana", "--log", log, "--seed", 1)
    assert (ran.code, ran.err) == (1, "")
    assert len(read_episode(log).steps) == 1
