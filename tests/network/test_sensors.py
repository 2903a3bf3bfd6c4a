"""Sensor models against scipy.stats, numerical integration and enumeration."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, stats

from palpate.network.noises import Noise, NormalNoise, StudentTNoise
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Below, Reading

TABLE = np.array([[0.7, 0.2, 0.0], [0.2, 0.5, 0.1], [0.1, 0.3, 0.9]])
LABELS = ("a", "b", "c")
X = np.linspace(0.0, 30.0, 7)


def confusion(repeat: float) -> ConfusionSensor:
    return ConfusionSensor("kind", LABELS, TABLE, repeat)


# Labels -----------------------------------------------------------------------------------------


def by_enumeration(repeat: float, labels: tuple[str, ...]) -> np.ndarray:
    """P(labels | state) with the hidden label, and for each look whether it repeats it, summed out."""
    total = np.zeros(3)
    for state, hidden in itertools.product(range(3), range(3)):
        for repeats in itertools.product([True, False], repeat=len(labels)):
            p = TABLE[hidden, state]
            for label, repeated in zip(labels, repeats, strict=True):
                index = LABELS.index(label)
                p *= repeat * (index == hidden) if repeated else (1 - repeat) * TABLE[index, state]
            total[state] += p
    return total


@given(st.floats(0, 1), st.lists(st.sampled_from(LABELS), min_size=1, max_size=4))
def test_labels_agree_with_enumeration(repeat: float, labels: list[str]) -> None:
    """The likelihood of several looks is the sum over the hidden label and over which looks repeat it."""
    expected = by_enumeration(repeat, tuple(labels))
    np.testing.assert_allclose(confusion(repeat).likelihood(labels), expected, atol=1e-14)


@given(st.floats(0, 1), st.lists(st.sampled_from(LABELS), max_size=3))
def test_predictive_is_the_ratio_of_likelihoods(repeat: float, labels: list[str]) -> None:
    """P(next | state, labels) x P(labels | state) = P(labels, next | state), and columns sum to one."""
    sensor = confusion(repeat)
    predictive, before = sensor.predictive(labels), sensor.likelihood(labels)
    np.testing.assert_allclose(predictive.sum(axis=0), 1)
    after = np.stack([sensor.likelihood([*labels, label]) for label in LABELS])
    np.testing.assert_allclose(predictive * before, after, atol=1e-14)


def test_a_camera_that_only_repeats_tells_nothing_twice() -> None:
    """With repeat probability 1 ten equal labels are worth one."""
    sensor = confusion(1.0)
    np.testing.assert_allclose(sensor.likelihood(["b"] * 10), sensor.likelihood(["b"]))


# Numbers ----------------------------------------------------------------------------------------

NOISES: dict[str, tuple[Noise, stats.rv_continuous]] = {
    "normal": (NormalNoise(), stats.norm()),
    "student-t": (StudentTNoise(3.0), stats.t(3)),
}


@pytest.mark.parametrize("name", NOISES)
def test_noise_is_that_of_scipy(name: str) -> None:
    """Density and distribution of the noise are scipy's."""
    noise, oracle = NOISES[name]
    z = np.linspace(-8, 8, 41)
    np.testing.assert_allclose(noise.log_density(z), oracle.logpdf(z), rtol=1e-12)
    np.testing.assert_allclose(noise.cdf(z), oracle.cdf(z), rtol=1e-9)
    np.testing.assert_allclose(noise.log_cdf(z), oracle.logcdf(z), rtol=1e-9)


def test_normal_noise_is_exact_in_the_far_tail() -> None:
    """The log distribution 1000 SDs out is finite and that of scipy."""
    assert NormalNoise().log_cdf(np.array(-1000.0)) == pytest.approx(stats.norm.logcdf(-1000))


@settings(max_examples=20)
@given(st.integers(1, 2**32 - 1))
def test_drawn_noise_follows_the_noise(seed: int) -> None:
    """Draws are reproducible and of the noise's distribution (Kolmogorov-Smirnov, generously)."""
    noise, oracle = NOISES["student-t"]
    rng = np.random.default_rng(seed)
    draws = [noise.draw(rng) for _ in range(200)]
    assert draws[0] == noise.draw(np.random.default_rng(seed))
    assert stats.kstest(draws, oracle.cdf).pvalue > 1e-9


@pytest.mark.parametrize("name", NOISES)
def test_likelihood_of_independent_readings(name: str) -> None:
    """Without an offset the log likelihood is the sum over readings and bounds."""
    noise, oracle = NOISES[name]
    sensor = NumberSensor("p", sd=2.0, relative_sd=0.1, noise=noise, low=1.0, high=25.0)
    scale = np.sqrt(4 + (0.1 * X) ** 2)
    expected = (
        oracle.logpdf((7 - X) / scale)
        - np.log(scale)
        + oracle.logpdf((8 - X) / 3)
        - np.log(3)
        + oracle.logsf((25 - X) / scale)
        + oracle.logcdf((1 - X) / scale)
    )
    found = sensor.log_likelihood([Reading(7.0), Reading(8.0, sd=3.0), Above(25.0), Below(1.0)], X)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def with_offset(noise: stats.rv_continuous, outcomes: list[Reading | Above | Below], x: float) -> float:
    """The likelihood with the shared offset N(0, 3^2) integrated by adaptive quadrature."""

    def term(outcome: Reading | Above | Below, offset: float) -> float:
        centre = x + offset
        if isinstance(outcome, Reading):
            scale = outcome.sd or 2.0
            return float(noise.pdf((outcome.value - centre) / scale) / scale)
        side = noise.sf if isinstance(outcome, Above) else noise.cdf
        return float(side((outcome.bound - centre) / 2.0))

    def integrand(offset: float) -> float:
        return float(stats.norm(0, 3).pdf(offset) * np.prod([term(o, offset) for o in outcomes]))

    return float(integrate.quad(integrand, -27, 27, limit=500, points=[-3, 0, 3], epsabs=0, epsrel=1e-10)[0])


MIXED = [
    [Reading(12.0)],
    [Reading(12.0), Reading(14.0, sd=1.0), Reading(9.0)],
    [Reading(12.0), Above(13.0)],
    [Below(16.0), Above(10.0), Reading(11.0)],
]


@pytest.mark.parametrize("name", NOISES)
@pytest.mark.parametrize("outcomes", MIXED, ids=str)
def test_likelihood_with_a_shared_offset(name: str, outcomes: list[Reading | Above | Below]) -> None:
    """Readings of one object that share an offset have the likelihood of the integral over it."""
    noise, oracle = NOISES[name]
    sensor = NumberSensor("p", sd=2.0, noise=noise, offset_sd=3.0)
    x = np.array([4.0, 10.0, 13.0, 20.0])
    expected = np.log([with_offset(oracle, outcomes, float(value)) for value in x])
    np.testing.assert_allclose(sensor.log_likelihood(outcomes, x), expected, atol=1e-6)


@pytest.mark.parametrize("name", NOISES)
@pytest.mark.parametrize("outcomes", [[], *MIXED], ids=str)
def test_predictive_is_the_ratio_of_likelihoods_of_readings(name: str, outcomes: list[Reading | Above | Below]) -> None:
    """p(next reading | x, readings) x p(readings | x) = p(readings, next reading | x)."""
    sensor = NumberSensor("p", sd=2.0, noise=NOISES[name][0], offset_sd=3.0)
    x, y = np.array([4.0, 10.0, 13.0]), np.array([3.0, 12.0, 20.0])
    density = sensor.predictive(outcomes, x).density(y)
    before = np.exp(sensor.log_likelihood(outcomes, x))
    after = np.stack([np.exp(sensor.log_likelihood([*outcomes, Reading(float(v))], x)) for v in y], axis=1)
    np.testing.assert_allclose(density * before[:, None], after, rtol=1e-6)


@pytest.mark.parametrize("offset_sd", [0.0, 3.0])
@pytest.mark.parametrize("name", NOISES)
def test_kernel_is_a_distribution(name: str, offset_sd: float) -> None:
    """Its density is the slope of its distribution, and below and above sum to one."""
    sensor = NumberSensor("p", sd=2.0, relative_sd=0.05, noise=NOISES[name][0], offset_sd=offset_sd)
    kernel, x, step = sensor.predictive([Reading(12.0)], X), np.linspace(-5, 40, 30), 1e-4
    slope = (kernel.cdf(x + step) - kernel.cdf(x - step)) / (2 * step)
    np.testing.assert_allclose(kernel.density(x), slope, atol=1e-6)
    np.testing.assert_allclose(kernel.cdf(x) + kernel.survival(x), 1, atol=1e-6)


def test_an_outcomes_own_sd_replaces_the_sensors() -> None:
    """A reading that brings its SD is read with it, relative noise included."""
    sensor = NumberSensor("p", sd=2.0, relative_sd=0.5)
    np.testing.assert_allclose(sensor.log_likelihood([Reading(3.0, sd=7.0)], X), stats.norm(X, 7).logpdf(3.0))


def test_purely_relative_noise_is_finite_at_zero() -> None:
    """A sensor whose noise vanishes with the value still has a density at zero."""
    sensor = NumberSensor("p", sd=0.0, relative_sd=0.1)
    assert np.isfinite(sensor.log_likelihood([Reading(0.0)], np.array([0.0]))).all()
