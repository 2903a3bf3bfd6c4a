"""Checks of calibration, on rows made up by hand."""

import pytest

from palpate.experiments.comparison.calibration_findings import checks, numbers, states
from tests.experiments.made_up import results, row


def test_states_are_the_means_over_objects() -> None:
    """Two beliefs of 0.8, one right and one wrong."""
    made = [
        row("w", "m", f"o{i}", 0, kind_truth=i, kind_probabilities=[0.8, 0.2], kind_correct=1.0 - i) for i in range(2)
    ]
    (found,) = states(results(made))
    assert found.accuracy == 0.5
    assert found.ece == pytest.approx(0.3)


def test_coverage_is_the_share_of_ranks_in_the_interval() -> None:
    """Ranks 0.1, 0.3, 0.6 and 0.96: two in the middle half, three in the middle nine tenths."""
    made = [row("w", "m", f"o{i}", 0, size_rank=rank) for i, rank in enumerate((0.1, 0.3, 0.6, 0.96))]
    (found,) = numbers(results(made))
    assert (found.within_50, found.within_90) == (0.5, 0.75)


def test_properties_of_which_nothing_is_said_are_left_out() -> None:
    """An engine without a belief about a property is not checked on it."""
    own = results([row("w", "m", "o0", 0, size_rank=None, size_crps=None), row("w", "m", "o1", 0, size_rank=None)])
    assert numbers(own) == []


def test_a_check_holds_within_its_tolerance() -> None:
    """Cross-entropy 0.82 and entropy 0.8 bits: within 0.03 bits of each other."""
    (first, *_) = checks(results([row("w", "m", "o0", 0, kind_cross_entropy_bits=0.82)]))
    assert first.holds
    (first, *_) = checks(results([row("w", "m", "o0", 0, kind_cross_entropy_bits=0.84)]))
    assert not first.holds
