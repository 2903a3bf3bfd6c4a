"""`palpate benchmark --robot mujoco`: the known objects in physics, each with sensors calibrated on the others."""

from pathlib import Path
from typing import Any

import pytest

from palpate.network.reading import read_document
from palpate.network.writing import to_toml

THINGS = ("banana", "banana_ycb", "ceramic_mug")


@pytest.fixture
def few(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A network that knows three objects."""
    tables = {key: value for key, value in read_document("household-filled").tables.items() if key != "extends"}
    objects: Any = tables["objects"]
    path = tmp_path / "few.toml"
    path.write_text(to_toml({**tables, "objects": {name: objects[name] for name in THINGS}}), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return path


def test_measured_explored_and_told(run: Any, few: Path) -> None:
    """A report with its figure; what was measured is kept, and the report can be made again without measuring."""
    command = ("benchmark", "--robot", "mujoco", "--network", "few.toml", "--repetitions", 2, "--workers", 1,
               "--output", "small")  # fmt: skip
    done = run(*command)
    assert done.code == 0
    assert done.out.count("3 objects") == 3
    report = (few.parent / "small" / "report.md").read_text()
    assert all(thing in report.replace("\\", "") for thing in THINGS)
    assert {"outcomes", "parts", "bench.png", "results.csv"} <= {path.name for path in (few.parent / "small").iterdir()}
    assert "--resume" in run(*command).refused
    (few.parent / "small" / "report.md").unlink()
    assert run("benchmark", "--figures-only", "--output", "small").code == 0
    assert (few.parent / "small" / "report.md").read_text() == report


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--robot", "mujoco", "--quick"), "--quick: for drawn objects"),
        (("--robot", "mujoco", "--calibration", "--objects", 9), "--calibration, --objects: for drawn objects"),
        (("--repetitions", 3), "--repetitions: for the bench alone"),
        (("--robot", "mujoco", "--network", "pantry"), "no shape of object"),
    ],
)
def test_bad_input_is_one_sentence(run: Any, few: Path, options: tuple[object, ...], message: str) -> None:
    """Nothing is measured."""
    assert message in run("benchmark", *options).refused
    assert {path.name for path in few.parent.iterdir()} == {"few.toml"}
