"""`palpate reproduce` in small."""

from pathlib import Path
from typing import Any

import pytest

SMALL = ("--object", "wineglass_ycb", "--repetitions", 1, "--workers", 1, "--network", "household-filled")


def test_it_runs_draws_and_tells(run: Any, tmp_path: Path) -> None:
    """The command ends with the claims and with where everything is; figures can be drawn again from the tables."""
    folder = tmp_path / "out"
    ran = run("reproduce", "-o", folder, "--engine", "exact", "--learn", "category", *SMALL)
    assert ran.code == 0, ran.err
    assert "Category: cat-vision is always chosen first" in ran.out
    assert str(folder / "report.md") in ran.out
    names = {path.name for path in folder.iterdir()}
    pictures = {"case_studies_exact.png", "actions.png", "entropy.png", "cross_entropy.png"}
    assert names == {"manifest.json", "parts", "report.md", *pictures} | {
        f"{table}.{kind}" for table in ("steps", "beliefs") for kind in ("csv", "parquet")
    }
    report = (folder / "report.md").read_text()
    for name in (*pictures, "report.md"):
        (folder / name).unlink()
    again = run("reproduce", "-o", folder, "--figures-only")
    assert again.code == 0, again.err
    assert (folder / "report.md").read_text() == report


def test_a_folder_is_not_overwritten_and_can_be_resumed(run: Any, tmp_path: Path) -> None:
    """A second run in the folder is refused; --resume with the same settings goes on, with others it is refused."""
    command = ("reproduce", "-o", tmp_path, "--engine", "exact", "--learn", "material", *SMALL)
    assert run(*command).code == 0
    assert "--resume" in run(*command).refused
    assert run(*command, "--resume").code == 0
    assert "of other settings" in run(*command, "--resume", "--seed", 9).refused


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--engine", "exakt"), "unknown engine 'exakt' (did you mean 'exact'?)"),
        (("--preset", "as-releasd"), "unknown preset 'as-releasd' (did you mean 'as-released'?)"),
        (("--engine", "exact", "--preset", "repaired"), "--preset repaired is only for --engine message-passing"),
        (("--learn", "colour"), "unknown objective 'colour'"),
        (("--data", "nowhere"), "nowhere: no folder experiment_<object> was found"),
        (("--figures-only",), "holds no steps.parquet"),
    ],
)
def test_bad_input_is_one_sentence(run: Any, tmp_path: Path, options: tuple[str, ...], said: str) -> None:
    """Whatever is wrong is told before anything is run."""
    assert said in run("reproduce", "-o", tmp_path / "out", *options).refused
