"""The paper's method on the command line: the same questions, null where it cannot say."""

import json
from pathlib import Path
from typing import Any

import pytest

from palpate.episode import read_episode
from palpate.network.reading import load_network
from palpate.summary import ContinuousSummary, UnsaidSummary

PASSING = ("--engine", "message-passing")
EVIDENCE: list[dict[str, Any]] = [
    {"action": "cat-vision", "label": "mug"},
    {"action": "mat-sound", "posterior": {"glass": 0.7, "ceramic": 0.3}},
    {"action": "weighing", "value": 118, "unit": "g", "sd": 4},
    {"action": "squeezing", "above": 95, "unit": "kPa"},
    {"action": "squeezing", "failed": True},
]


@pytest.mark.parametrize("preset", [(), ("--preset", "repaired"), ("--preset", "as-written")])
def test_json_has_the_same_fields_and_null_for_what_is_not_known(run: Any, evidence_file: Any, preset: Any) -> None:
    """Every property and action stands there; mass, everything and the log evidence are null."""
    network = load_network("household")
    ran = run("infer", evidence_file(EVIDENCE), "--json", *PASSING, *preset)
    assert ran.code == 0, ran.err
    found = json.loads(ran.out)
    assert list(found) == ["properties", "expected_gain_bits", "log_evidence_bits", "evidence"]
    assert list(found["properties"]) == list(network.properties)
    nothing = {"0.05": None, "0.5": None, "0.95": None}
    assert found["properties"]["mass"] == {
        "unit": "g", "mean": None, "sd": None, "quantiles": nothing, "entropy_bits": None,
    }  # fmt: skip
    assert found["properties"]["category"]["probabilities"]["mug"] > 0.9
    assert found["properties"]["elasticity"]["quantiles"]["0.05"] > 95
    for gains in found["expected_gain_bits"].values():
        assert list(gains) == [*network.properties, "everything"]
        assert [name for name, gain in gains.items() if gain is None] == ["mass", "everything"]
    assert found["log_evidence_bits"] is None
    assert [entry["surprise"] is None for entry in found["evidence"]] == [False, True, True, False, True]


def test_tables_say_where_nothing_is_known(run: Any, evidence_file: Any) -> None:
    """For people mass is a line that says so, and a gain that is not known a dash."""
    ran = run("infer", evidence_file(EVIDENCE[:1]), *PASSING)
    assert ran.code == 0, ran.err
    (line,) = (line for line in ran.out.splitlines() if line.startswith("mass") and "engine" in line)
    assert line.split() == ["mass", "not", "said", "by", "this", "engine"]
    (line,) = (line for line in ran.out.splitlines() if line.startswith("everything"))
    assert line.split() == ["everything", *"-----"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--engine", "message-pasing"), "--engine: unknown engine 'message-pasing'"),
        ((*PASSING, "--preset", "as-relesed"), "--preset: unknown preset 'as-relesed' (did you mean 'as-released'?)"),
        (("--preset", "repaired"), "--preset repaired is only for --engine message-passing, and the engine is exact"),
        ((*PASSING, "--network", "pantry"), "network 'pantry': it has no property"),
    ],
)
def test_bad_engines_are_one_sentence(run: Any, evidence_file: Any, options: Any, said: str) -> None:
    """An unknown engine or preset, and a network without the published graph, end with exit code 2."""
    assert said in run("infer", evidence_file(EVIDENCE), *options).refused


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ((), "cannot say what action 'cat-vision' tells about 'everything'"),
        (("--learn", "mass"), "cannot say what action 'cat-vision' tells about 'mass'"),
        (("--learn", "category", "--policy", "look-ahead:2"), "--policy look-ahead:2 looks ahead, which needs"),
        (("--learn", "category", "--policy", "static:2"), "--policy static:2 looks ahead, which needs"),
    ],
)
def test_an_exploration_that_the_engine_cannot_do_is_refused(run: Any, options: Any, said: str) -> None:
    """An objective or a policy that needs more than marginals is refused before the first step."""
    assert said in run("explore", "ceramic_mug", *PASSING, *options).refused


def test_an_exploration_is_shown_logged_and_drawn(run: Any, tmp_path: Path) -> None:
    """Explore, keep the log and draw it; the same seed takes the same steps, the log reads back."""
    log, plot = tmp_path / "episode.jsonl", tmp_path / "episode.png"
    command = ("explore", "wineglass", *PASSING, "--learn", "material", "--stop", "net-gain:0", "--seed", 4)
    ran = run(*command, "--log", log, "--plot", plot)
    assert ran.code == 0, ran.err
    assert "engine message-passing" in ran.out
    assert "not said by this engine" in ran.out
    episode = read_episode(log)
    assert episode.steps[0].action == "weighing"
    assert isinstance(episode.prior["mass"], UnsaidSummary)
    assert isinstance(episode.posterior["density"], ContinuousSummary)
    assert plot.stat().st_size > 0
    assert run(*command).out == ran.out
    assert run("episode", "plot", log, tmp_path / "again.png").code == 0
