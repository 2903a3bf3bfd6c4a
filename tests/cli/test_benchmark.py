"""`palpate benchmark` from the command line."""

from pathlib import Path

import pytest

from palpate.cli import benchmarking, main
from palpate.experiments.comparison.contest import ContestTask
from palpate.experiments.comparison.methods import few_methods
from palpate.experiments.comparison.optimum import OptimumTask
from palpate.experiments.comparison.plan import Size
from palpate.experiments.comparison.worlds import worlds
from palpate.experiments.running import Task


def run(*arguments: object) -> int:
    with pytest.raises(SystemExit) as end:
        main(["benchmark", *map(str, arguments)])
    assert isinstance(end.value.code, int)
    return end.value.code


def test_a_calibration_is_run_once_and_drawn_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Tables, report and picture are there; a second run is refused, and the picture can be drawn again."""
    folder = tmp_path / "out"
    asked = ("--calibration", "--objects", 12, "--workers", 1, "--output", folder)
    assert run(*asked) == 0
    assert "category: class-wise ECE" in capsys.readouterr().out
    assert {"results.parquet", "results.csv", "report.md", "calibration.png"} <= {p.name for p in folder.iterdir()}
    assert "probabilities" not in (folder / "results.csv").read_text(encoding="utf-8").splitlines()[0]
    (folder / "calibration.png").unlink()
    assert run(*asked) == 2
    assert "--resume" in capsys.readouterr().err
    assert run("--figures-only", "--output", folder) == 0
    assert (folder / "calibration.png").exists()


def test_a_comparison_says_its_verdict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The verdict of the primary contrast is printed, and the report names its figures."""

    def tasks(size: Size, seed: int, network: str) -> list[Task]:
        methods = few_methods()[:3]
        assert network == "household-filled"
        return [OptimumTask(worlds()[0], 1), ContestTask(worlds()[0], methods, size.in_model, 0, 2, 1, seed)]

    monkeypatch.setattr(benchmarking, "comparison_tasks", tasks)
    assert run("--quick", "--objects", 2, "--workers", 1, "--output", tmp_path) == 0
    assert "Primary contrast:" in capsys.readouterr().out
    report = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "kind quick comparison" in report
    assert all((tmp_path / name).exists() for name in ("learning.png", "worlds.png", "stopping.png", "gains.png"))
    assert "](learning.png)" in report


def test_what_cannot_be_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A quick calibration, and figures of a folder without a run, are errors of one sentence."""
    assert run("--quick", "--calibration", "--output", tmp_path) == 2
    assert "expected one of the two" in capsys.readouterr().err
    assert run("--figures-only", "--output", tmp_path) == 2
    assert "results.parquet" in capsys.readouterr().err
