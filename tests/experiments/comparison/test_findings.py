"""Contrasts of methods, on rows made up by hand."""

import pytest

from palpate.experiments.comparison.findings import primary, secondary, under_changes, verdict
from palpate.experiments.comparison.worlds import worlds
from palpate.experiments.statistics import Contrast
from tests.experiments.made_up import results, rows

RESULTS = results(list(rows()))


def test_the_primary_contrast_is_the_mean_of_all_steps_by_object() -> None:
    """Made up so that exact greedy is one bit better with every object."""
    first, beside = primary(RESULTS)
    assert (first.name, beside.name) == ("exact-greedy less actsel", "exact-greedy less actsel-best-case")
    assert first.mean == pytest.approx(-1)
    assert (first.objects, first.p) == (4, 0.125)


def test_secondary_contrasts_are_one_family() -> None:
    """Only contrasts of methods that were run, all with p-values after Holm, none lower than its own."""
    found = secondary(RESULTS)
    assert "actsel-scored-exact less actsel" in [one.name for one in found]
    assert all(one.adjusted_p is not None and one.adjusted_p >= one.p for one in found)
    few = results([r for r in rows() if r["method"] in ("exact-greedy", "rand-scored-exact")])
    assert [one.name for one in secondary(few)] == ["exact-greedy less rand-scored-exact"]


def test_every_world_has_both_contrasts() -> None:
    """The primary contrast and that against the best case stand for each world."""
    found = under_changes(RESULTS)
    assert list(found) == [world.name for world in worlds()]
    assert {one.name for pair in found.values() for one in pair} == {one.name for one in primary(RESULTS)}


def test_a_verdict_of_no_difference_keeps_its_interval() -> None:
    """Where chance explains a difference, the sentence says so and gives the figures all the same."""
    found = Contrast("a less b", -0.1, -0.3, 0.1, 0.02, 20, adjusted_p=0.2)
    expected = "No difference between a and b was found (95 % interval -0.300 to 0.100, p = 0.02, 0.2 after Holm"
    assert verdict(found).startswith(expected)
