"""Statistics of paired comparisons against scipy, enumeration and hand-computed cases."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from palpate.errors import EvidenceError
from palpate.experiments.statistics import (
    Contrast,
    adjusted,
    bootstrap_interval,
    contrast,
    holm,
    object_means,
    sign_flip_p,
)

DIFFERENCES = np.array([0.3, -0.1, 0.8, 0.5, -0.2, 0.9, 0.4, 0.1])


def test_sign_flips_are_those_of_scipy() -> None:
    """For few objects the p-value is that of scipy's exact permutation test of paired samples."""
    found = stats.permutation_test(
        (DIFFERENCES, np.zeros(8)), lambda x, y: np.mean(x - y), permutation_type="samples", n_resamples=np.inf
    )
    assert sign_flip_p(DIFFERENCES) == pytest.approx(found.pvalue)


@given(st.lists(st.floats(-5, 5), min_size=1, max_size=7))
def test_sign_flips_by_enumeration(values: list[float]) -> None:
    """The p-value is the share of all sign flips whose sum is at least as far from zero."""
    sums = [
        abs(sum(s * v for s, v in zip(signs, values, strict=True))) for signs in product((1, -1), repeat=len(values))
    ]
    at_least = np.mean([total >= abs(sum(values)) - 1e-9 for total in sums])
    more = np.mean([total >= abs(sum(values)) + 1e-9 for total in sums])
    assert more <= sign_flip_p(np.array(values)) <= at_least


def test_drawn_sign_flips_are_near_the_exact_ones() -> None:
    """With more objects flips are drawn: the p-value is near that of a normal sum, and repeats."""
    values = np.random.default_rng(3).normal(0.15, 1.0, 200)
    normal = 2 * stats.norm.sf(abs(values.sum()) / np.sqrt((values**2).sum()))
    assert sign_flip_p(values, seed=1) == pytest.approx(normal, abs=0.015)
    assert sign_flip_p(values, seed=1) == sign_flip_p(values, seed=1)


def test_the_bootstrap_interval_is_that_of_a_normal_mean() -> None:
    """With many objects the interval is the mean and about 1.96 standard errors either way."""
    values = np.random.default_rng(5).normal(2.0, 3.0, 400)
    error = values.std() / np.sqrt(400)
    low, high = bootstrap_interval(values)
    assert low == pytest.approx(values.mean() - 1.96 * error, abs=0.1 * error)
    assert high == pytest.approx(values.mean() + 1.96 * error, abs=0.1 * error)


def test_holm_by_hand() -> None:
    """0.005 x 4, 0.01 x 3, then 0.03 x 2, and 0.04 takes over what came before it."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


@given(st.lists(st.floats(0, 1), max_size=8))
def test_holm_keeps_the_order_and_never_lowers(p_values: list[float]) -> None:
    """Adjusted p-values are at least the ones given, at most one, and in the same order."""
    found = holm(p_values)
    assert all(p <= a <= 1 for p, a in zip(p_values, found, strict=True))
    order = np.argsort(p_values, kind="stable")
    assert all(np.diff(np.array(found)[order]) >= 0)


def test_object_means_leave_out_what_is_missing() -> None:
    """A missing value does not count, an object with none has no mean, and weights weigh."""
    values = np.array([1.0, np.nan, 4.0, np.nan])
    assert object_means(["a", "a", "a", "b"], values, np.array([3.0, 9.0, 1.0, 1.0])) == {"a": 1.75}


def test_a_contrast_is_over_the_objects_that_both_have() -> None:
    """Objects of one arm only are left out."""
    found = contrast("a less b", {"x": 1.0, "y": 3.0, "z": 9.0}, {"y": 1.0, "x": 1.0})
    assert (found.mean, found.objects) == (1.0, 2)
    assert found.low <= found.mean <= found.high


def test_a_family_is_adjusted_together() -> None:
    """Each contrast of a family carries the p-value after Holm beside its own."""
    family = [Contrast("a", 0, 0, 0, 0.01, 5), Contrast("b", 0, 0, 0, 0.04, 5)]
    assert [(one.p, one.adjusted_p) for one in adjusted(family)] == [(0.01, 0.02), (0.04, 0.04)]


def test_nothing_in_common_is_an_error() -> None:
    """Arms without a shared object cannot be compared."""
    with pytest.raises(EvidenceError, match="no object was found"):
        contrast("a less b", {"x": 1.0}, {"y": 1.0})
