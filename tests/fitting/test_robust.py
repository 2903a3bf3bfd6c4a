"""Location and spread of values some of which are wrong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.fitting.forms import Form, LogNormalForm, NormalForm
from palpate.fitting.likelihood import Prior
from palpate.fitting.robust import SURE, estimate, resolution, widened

FREE = NormalForm(-np.inf, np.inf)
REPEATS = 80
samples = st.lists(st.integers(-50, 50), min_size=3, max_size=30).filter(lambda x: len(set(x)) > 1)


@pytest.mark.parametrize("count", [10, 30, 100])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_tenth_of_wrong_values_changes_little(count: int, side: int) -> None:
    """With a tenth of the values far off, mean and SD are those of the others, whose names are known."""
    x = np.random.default_rng(count).normal(10, 2, count)
    bad = np.zeros(count, dtype=bool)
    bad[: count // 10] = True
    found = estimate(FREE, np.where(bad, 10 + side * 200.0, x), 1e-6)
    assert not found.used[bad].any()
    good = x[found.used]
    assert found.location == pytest.approx(good.mean(), rel=1e-4)
    assert found.spread == pytest.approx(good.std() * widened(len(good)), rel=1e-3)
    assert (~found.used & ~bad).sum() <= 1


@pytest.mark.parametrize("form", [FREE, NormalForm(9.0, np.inf), LogNormalForm()])
@pytest.mark.parametrize("count", [6, 40])
def test_few_samples_without_errors_lose_a_value(form: Form, count: int) -> None:
    """About one in twenty samples of right values loses some, at most four SDs of a binomial more, and few."""
    rng = np.random.default_rng(count)
    prior = Prior(10.0, 10.0, 2.0) if isinstance(form, NormalForm) else Prior(2.3, 1.0, 0.2)
    lost = 0
    for _ in range(REPEATS):
        x = rng.normal(10, 2, 20 * count)
        x = x[x > 9][:count] if form == NormalForm(9.0, np.inf) else x[:count]
        x = np.exp(2.3 + 0.1 * (x - 10)) if isinstance(form, LogNormalForm) else x
        used = estimate(form, x, 1e-6, prior).used
        assert (~used).sum() <= 3
        lost += not used.all()
    assert lost <= REPEATS * SURE + 4 * np.sqrt(REPEATS * SURE * (1 - SURE))


def test_of_four_values_none_is_the_odd_one() -> None:
    """Fewer than five values are all used, however odd one looks."""
    assert estimate(FREE, np.array([1.0, 1.1, 0.9, 1e6]), 1e-6).used.all()


@settings(max_examples=25)
@given(samples, st.randoms())
def test_the_order_of_values_does_not_matter(values: list[int], random: object) -> None:
    """Shuffled values give the same numbers to the last bit, and the same values are left out."""
    x = np.array(values, dtype=float)
    order = np.array(sorted(range(len(x)), key=lambda _: random.random()))  # type: ignore[attr-defined]
    one, other = estimate(FREE, x, 0.1), estimate(FREE, x[order], 0.1)
    assert (one.location, one.spread) == (other.location, other.spread)
    assert sorted(x[one.used]) == sorted(x[order][other.used])


@settings(max_examples=25)
@given(samples)
def test_values_twice_have_the_same_mean(values: list[int]) -> None:
    """All values twice have the same location where none is left out, and nearly the same most likely spread."""
    x = np.array(values, dtype=float)
    one, twice = estimate(FREE, x, 0.1), estimate(FREE, np.tile(x, 2), 0.1)
    if one.used.all() and twice.used.all():
        assert twice.location == pytest.approx(one.location, abs=2e-4 * one.spread)
        assert twice.spread / widened(2 * len(x)) == pytest.approx(one.spread / widened(len(x)), rel=1e-3)


@settings(max_examples=25)
@given(samples, st.floats(0.01, 100), st.floats(-100, 100))
def test_units_do_not_matter(values: list[int], scale: float, shift: float) -> None:
    """Values in another unit have location and spread in that unit."""
    x = np.array(values, dtype=float)
    one, other = estimate(FREE, x, 0.1), estimate(FREE, scale * x + shift, 0.1 * scale)
    assert other.location == pytest.approx(scale * one.location + shift, abs=1e-3 * scale * one.spread)
    assert other.spread == pytest.approx(scale * one.spread, rel=1e-3)


def test_values_that_are_all_the_same() -> None:
    """Where values agree, the spread is that of their rounding, and not zero."""
    found = estimate(FREE, np.full(9, 7.0), 0.1)
    assert found.used.all()
    assert (found.location, found.spread) == pytest.approx((7.0, 0.1 * widened(9)))
    assert resolution(np.array([3.0, 3.0])) == 0
