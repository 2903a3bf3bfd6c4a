"""Figures of a comparison and of a calibration are drawn from the table alone."""

from pathlib import Path

from matplotlib.image import imread

from palpate.figures.calibration import draw_calibration
from palpate.figures.comparison import draw_comparison
from tests.experiments.made_up import results, rows


def test_every_picture_is_drawn(tmp_path: Path) -> None:
    """All pictures that are named exist and are no blank sheet."""
    pictures = draw_comparison(results(list(rows())), tmp_path)
    assert set(tmp_path.iterdir()) == set(pictures.values())
    assert all(imread(path)[..., :3].std() > 0.02 for path in pictures.values())


def test_methods_that_were_not_run_are_left_out(tmp_path: Path) -> None:
    """A comparison of few methods has the same pictures."""
    kept = ("exact-greedy", "actsel", "actsel-best-case", "optimal", "greedy", "best set", "any set")
    assert len(draw_comparison(results([r for r in rows() if r["method"] in kept]), tmp_path)) == 4


def test_a_calibration_is_drawn(tmp_path: Path) -> None:
    """A panel for each property, and no blank sheet."""
    own = [r for r in rows(30) if r["method"] == "exact-greedy" and r["step"] == 2 and r["world"] == "in-model"]
    draw_calibration(results(own), tmp_path / "calibration.png")
    assert imread(tmp_path / "calibration.png")[..., :3].std() > 0.02
