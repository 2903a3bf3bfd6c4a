"""Most likely parameters against a search over a fine grid with the densities of scipy."""

import numpy as np
import pytest
from scipy import stats

from palpate.fitting.forms import FARTHEST, Form, GammaForm, LogNormalForm, NormalForm, StudentForm
from palpate.fitting.likelihood import Prior, Sample, most_likely

X = np.sort(np.array([2.1, 2.9, 3.3, 3.8, 4.4, 5.0, 6.1]))
CASES: dict[str, tuple[Form, object]] = {
    "normal": (NormalForm(-np.inf, np.inf), stats.norm),
    "truncated": (NormalForm(0.0, np.inf), lambda a, b: stats.truncnorm(-a / b, np.inf, a, b)),
    "both ends": (NormalForm(0.0, 8.0), lambda a, b: stats.truncnorm(-a / b, (8 - a) / b, a, b)),
    "lognormal": (LogNormalForm(), lambda a, b: stats.lognorm(b, scale=np.exp(a))),
    "gamma": (GammaForm(), lambda a, b: stats.gamma(b**-2, scale=np.exp(a) * b**2)),
    "student": (StudentForm(4.0), lambda a, b: stats.t(4, a, b)),
}


@pytest.mark.parametrize("censored", [0, 2])
@pytest.mark.parametrize("name", CASES)
def test_no_point_of_a_grid_is_more_likely(name: str, censored: int) -> None:
    """The likelihood of a fine grid around the estimate is nowhere larger, and its best point is next to it."""
    form, density = CASES[name]
    sample = Sample(X, censored, censored)
    start = (float(np.median(form.values(X))), 1.0)
    location, spread = most_likely(form, sample, start, 1e-6)

    def cost(a: float, b: float) -> float:
        made = density(a, b)  # type: ignore[operator]
        return -float(made.logpdf(X).sum() + censored * (made.logcdf(X[0]) + made.logsf(X[-1])))

    offsets = np.linspace(-0.3, 0.3, 25)
    grid = {(i, j): cost(location + spread * i, spread * np.exp(j)) for i in offsets for j in offsets}
    best = min(grid, key=lambda place: grid[place])
    assert abs(best[0]) <= 0.026
    assert abs(best[1]) <= 0.026
    assert cost(location, spread) <= min(grid.values()) + 1e-6


def test_a_normal_has_its_closed_form() -> None:
    """Without truncation the most likely mean and SD are those of the values, divided by n."""
    found = most_likely(NormalForm(-np.inf, np.inf), Sample(X), (1.0, 1.0), 1e-6)
    np.testing.assert_allclose(found, [X.mean(), X.std()], rtol=1e-4)


def test_moments_are_not_the_answer_where_there_is_a_limit() -> None:
    """Of many values of a truncated normal the estimates are the parameters before truncation, not the moments."""
    x = np.sort(stats.truncnorm(-0.2, np.inf, 10, 50).rvs(4000, random_state=np.random.default_rng(1)))
    location, spread = most_likely(NormalForm(0.0, np.inf), Sample(x), (float(x.mean()), float(x.std())), 1e-6)
    assert x.mean() > 40
    assert location == pytest.approx(10, abs=12)
    assert spread == pytest.approx(50, abs=5)


def test_a_truncated_mean_does_not_run_away() -> None:
    """Values that fall off like an exponential, or slower, give a mean three SDs beyond the limit and not further."""
    x = np.sort(np.random.default_rng(0).exponential(1.0, 300) ** 1.5)
    location, spread = most_likely(NormalForm(0.0, np.inf), Sample(x), (1.0, 1.0), 1e-6)
    assert location == pytest.approx(-FARTHEST * spread, rel=1e-6)


def test_the_prior_by_hand() -> None:
    """With the spread held by a narrow floor, the location is the precision-weighted mean of values and prior."""
    x, floor = np.array([4.0, 4.0, 4.0, 4.0]), 2.0
    location, spread = most_likely(NormalForm(-np.inf, np.inf), Sample(x), (4.0, 2.0), floor, Prior(0.0, 1.0, 1e-3))
    assert spread == pytest.approx(floor, rel=1e-3)
    assert location == pytest.approx(4 * (4 / 4) / (4 / 4 + 1), rel=1e-3)
