"""The families of prior densities against scipy.stats, which shares no code with them."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, stats

from palpate.network.families import Family, Gamma, LogNormal, Normal, StudentT, Uniform


def pair(first: float, second: float) -> np.ndarray:
    return np.array([first, second], dtype=float)


CASES: dict[str, tuple[Family, list[stats.rv_continuous]]] = {
    "normal": (
        Normal(pair(3, -2), pair(1, 4), pair(-np.inf, -np.inf), pair(np.inf, np.inf)),
        [stats.norm(3, 1), stats.norm(-2, 4)],
    ),
    "truncated at zero": (
        Normal(pair(3, -2), pair(2, 4), pair(0, 0), pair(np.inf, np.inf)),
        [stats.truncnorm(-1.5, np.inf, 3, 2), stats.truncnorm(0.5, np.inf, -2, 4)],
    ),
    "truncated at both ends": (
        Normal(pair(3, 9), pair(2, 1), pair(0, 0), pair(4, 7)),
        [stats.truncnorm(-1.5, 0.5, 3, 2), stats.truncnorm(-9, -2, 9, 1)],
    ),
    "lognormal": (
        LogNormal(pair(3, 0.2), pair(0.5, 1.5)),
        [stats.lognorm(0.5, scale=3), stats.lognorm(1.5, scale=0.2)],
    ),
    "gamma": (Gamma(pair(0.7, 6), pair(2, 0.5)), [stats.gamma(0.7, scale=2), stats.gamma(6, scale=0.5)]),
    "uniform": (Uniform(pair(0, -2), pair(1, 3)), [stats.uniform(0, 1), stats.uniform(-2, 5)]),
    "student-t": (StudentT(pair(1, -4), pair(2, 0.5), pair(3, 30)), [stats.t(3, 1, 2), stats.t(30, -4, 0.5)]),
}


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> tuple[Family, list[stats.rv_continuous]]:
    return CASES[request.param]


def test_density_is_that_of_scipy(case: tuple[Family, list[stats.rv_continuous]]) -> None:
    """The log density of each configuration is scipy's, -inf outside the support included."""
    family, oracles = case
    x = np.linspace(-12.03, 17.01, 301)
    expected = np.stack([oracle.logpdf(x) for oracle in oracles])
    np.testing.assert_allclose(family.log_density(x), expected, rtol=1e-9, atol=1e-12)


def test_cdf_is_that_of_scipy(case: tuple[Family, list[stats.rv_continuous]]) -> None:
    """The distribution function of each configuration is scipy's."""
    family, oracles = case
    x = np.linspace(-12.03, 17.01, 301)
    np.testing.assert_allclose(family.cdf(x), np.stack([oracle.cdf(x) for oracle in oracles]), rtol=1e-7, atol=1e-12)


def test_quantile_inverts_the_cdf(case: tuple[Family, list[stats.rv_continuous]]) -> None:
    """cdf(quantile(p)) = p for p from one in a million to its complement."""
    family, _ = case
    p = np.array([1e-6, 0.01, 0.3, 0.5, 0.9, 1 - 1e-6])
    x = family.quantile(p)
    again = np.stack([family.cdf(row)[index] for index, row in enumerate(x)])
    np.testing.assert_allclose(again, np.broadcast_to(p, x.shape), rtol=1e-6)


def test_support_holds_all_of_the_mass(case: tuple[Family, list[stats.rv_continuous]]) -> None:
    """The quantiles of 0 and 1 are the ends of the support."""
    family, oracles = case
    ends = np.array([oracle.support() for oracle in oracles])
    np.testing.assert_allclose(np.stack([family.low, family.high], axis=1), ends)


def test_densities_integrate_to_one(case: tuple[Family, list[stats.rv_continuous]]) -> None:
    """Each density integrates to one over its support, by scipy's adaptive quadrature."""
    family, oracles = case
    for index, oracle in enumerate(oracles):

        def density(x: float, index: int = index) -> float:
            return float(np.exp(family.log_density(np.array(x))[index]))

        body = oracle.ppf([1e-12, 0.5, 1 - 1e-12])
        total = sum(integrate.quad(density, low, high, limit=200)[0] for low, high in pairwise(body))
        assert total == pytest.approx(1, abs=1e-6)


def test_a_property_without_parents_has_scalar_parameters() -> None:
    """Parameters without axes give densities of the shape of x alone."""
    family = Normal(np.array(3.0), np.array(1.0), np.array(0.0), np.array(np.inf))
    x = np.linspace(0, 6, 5)
    np.testing.assert_allclose(family.log_density(x), stats.truncnorm(-3, np.inf, 3, 1).logpdf(x))
    assert family.quantile(np.array(0.5)).shape == ()


@given(st.floats(-40, 8), st.floats(0.01, 0.99))
def test_far_truncation_stays_finite(mean: float, p: float) -> None:
    """A normal cut off tens of SDs from its mean still has a median, a CDF and a density."""
    family = Normal(np.array([mean]), np.array([1.0]), np.array([0.0]), np.array([np.inf]))
    x = family.quantile(np.array(p))
    assert x[0] >= 0
    assert family.cdf(x)[0, 0] == pytest.approx(p, rel=1e-6)
    assert np.isfinite(family.log_density(x)[0, 0])


def test_far_truncation_has_the_exponential_limit() -> None:
    """Cut off 50 SDs above its mean, a normal is an exponential with rate 50 to first order."""
    family = Normal(np.array([-50.0]), np.array([1.0]), np.array([0.0]), np.array([np.inf]))
    assert family.quantile(np.array([0.5]))[0, 0] == pytest.approx(np.log(2) / 50, rel=1e-3)


def test_local_scale_is_positive_where_there_is_mass(case: tuple[Family, list[stats.rv_continuous]]) -> None:
    """The length of change is positive and finite at every likely value."""
    family, oracles = case
    for index, oracle in enumerate(oracles):
        for x in oracle.ppf([0.001, 0.5, 0.999]):
            assert 0 < family.local_scale(float(x))[index] < np.inf
