"""The reports, on rows made up by hand."""

from palpate.experiments.comparison.belief_sections import calibration_report
from palpate.experiments.comparison.methods import all_methods
from palpate.experiments.comparison.report import comparison_report
from palpate.experiments.comparison.worlds import worlds
from tests.experiments.made_up import results, rows

TEXT = comparison_report(results(list(rows())), {"seed": 3, "kind": "made up"})


def test_the_report_says_what_it_does_not_show() -> None:
    """It says that simulated data favour exact inference, that no real robot is meant, and the floor."""
    words = " ".join(TEXT.split())
    assert "favours exact inference by construction" in words
    assert "No claim is made about a real robot" in words
    assert "floored at 1e-06" in words
    assert "seed 3, kind made up" in words


def test_the_report_gives_the_verdict_of_the_primary_contrast() -> None:
    """The one primary contrast has a sentence of its own, in bold."""
    assert "**exact-greedy is lower than actsel by" in TEXT or "**No difference between exact-greedy and actsel" in TEXT


def test_every_method_and_world_is_in_the_report() -> None:
    """None is left out."""
    assert not [method.name for method in all_methods() if f"| {method.name} |" not in TEXT]
    assert not [world.name for world in worlds() if f"| {world.name} |" not in TEXT]


def test_tables_are_whole() -> None:
    """All rows of a table have as many cells as its head."""
    for section in TEXT.split("\n\n"):
        lines = [line for line in section.splitlines() if line.startswith("|")]
        assert len({line.count("|") for line in lines}) <= 1


def test_a_calibration_has_a_verdict_for_each_check() -> None:
    """Two checks for each categorical property and two for each continuous one."""
    own = results([r for r in rows() if r["method"] == "exact-greedy" and r["step"] == 2 and r["world"] == "in-model"])
    lines = calibration_report(own, {}).splitlines()
    assert sum(line.endswith(("| holds |", "| does not hold |")) for line in lines) == 4
