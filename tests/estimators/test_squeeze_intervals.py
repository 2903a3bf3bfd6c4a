"""Squeezing: an SD that is told is the SD, whatever errs; and what does not come from the object is noticed."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

from palpate.estimators.correlated import covariance_of_fit
from palpate.estimators.squeezing import Jaws, Squeeze, squeeze
from palpate.estimators.steps import slope_variance_of_steps, step_of
from palpate.outcomes import Failed, Reading

AREA_MM2, WIDTH_MM, STEP_MM = 1500.0, 55.0, 0.37


def squeezed(
    modulus_kpa: float,
    rng: np.random.Generator,
    *,
    pace_mm: float = 0.2,
    step_mm: float = STEP_MM,
    noise_n: float = 0.3,
    alike: float = 0.0,
    drift_n: float = 0.0,
    cut: float = 1.0,
    power: float = 1.0,
) -> Squeeze:
    """Jaws that begin anywhere, 20 mm before contact, and close by as much again or until 60 N."""
    stiffness = modulus_kpa * 1e-3 * AREA_MM2 / WIDTH_MM
    way = min(20.0, 60.0 / stiffness)
    count = int((20 + way) / pace_mm)
    gap = WIDTH_MM + 20 + rng.uniform(0, STEP_MM) - pace_mm * np.arange(count)
    force = stiffness * way * (np.maximum(0, WIDTH_MM - gap) / way) ** power
    force = np.minimum(force, cut * force.max()) + drift_n * np.arange(count)
    fresh = rng.normal(0, 1, count) * np.where(np.arange(count), np.sqrt(1 - alike**2), 1.0)
    force = force + noise_n * lfilter([1.0], [1.0, -alike], fresh)
    read = np.round(gap / step_mm) * step_mm if step_mm else gap
    return squeeze(read, force, Jaws(AREA_MM2, WIDTH_MM, gap_sd_mm=step_mm / 12**0.5))


def in_sds(found: Squeeze, modulus_kpa: float) -> float:
    assert isinstance(found.outcome, Reading), found.outcome
    return (found.modulus_kpa - modulus_kpa) / found.sd_kpa


@pytest.mark.parametrize(("least", "most"), [(0.34, 0.37), (0.1, 1.0)])
def test_intervals_hold_what_they_say(least: float, most: float) -> None:
    """Of intervals of 90 % no more than a tenth miss, by the binomial's 99.9 %: by about a step a sample, and else."""
    rng = np.random.default_rng(50)
    found = []
    for _ in range(200):
        modulus = rng.uniform(6, 80)
        noise = rng.choice([0.05, 0.15, 0.3])
        found.append(in_sds(squeezed(modulus, rng, pace_mm=rng.uniform(least, most), noise_n=noise), modulus))
    missed = int(np.sum(np.abs(found) > 1.6449))
    assert missed <= binom.ppf(0.999, 200, 0.1)
    # and they are no wider than is good for anything
    assert 0.5 < np.std(found) < 1.2


@pytest.mark.parametrize(("step_mm", "alike"), [(0.0, 0.0), (0.0, 0.9), (STEP_MM, 0.9), (STEP_MM, 0.97)])
def test_a_force_that_wanders_is_as_uncertain_as_it_is(step_mm: float, alike: float) -> None:
    """Noise that resembles itself from sample to sample makes the SD larger, by as much as the readings scatter."""
    rng = np.random.default_rng(51)
    all_of_them = [squeezed(40.0, rng, step_mm=step_mm, alike=alike) for _ in range(80)]
    # a large wave of the force may look like a slip
    found = [in_sds(each, 40.0) for each in all_of_them if not isinstance(each.outcome, Failed)]
    assert len(found) >= 76
    assert 0.55 < np.std(found) < 1.25
    assert np.sum(np.abs(found) > 1.6449) <= binom.ppf(0.999, 80, 0.1)


@pytest.mark.parametrize("pace", [0.99, 0.98, 0.95, 0.7, 2.01])
def test_the_variance_by_steps_is_that_of_lines_through_saw_teeth(pace: float) -> None:
    """Lines fitted to rounded ways of paces that one pair of ends allows scatter as the sum of harmonics says."""
    rng, count, slopes, told = np.random.default_rng(52), 60, [], []
    order = np.arange(count)
    for _ in range(1500):
        # a pace that its own ends do not tell from this one
        way = -(pace + rng.uniform(-0.5, 0.5) / count) * order + rng.uniform()
        slopes.append(count * np.polyfit(order, np.round(way) - way, 1)[0])
        told.append(slope_variance_of_steps(np.round(way), 1.0))
    independent = 1 / count
    assert np.var(slopes) <= 1.4 * (np.mean(told) + independent)
    assert np.mean(told) <= 2.5 * np.var(slopes) + independent


def test_a_gap_without_steps_has_none() -> None:
    """What comes in steps is told from what comes as it likes; and a step is no larger than the SD tells of."""
    rng = np.random.default_rng(53)
    gap = np.linspace(75, 45, 150)
    assert step_of(np.round(gap / STEP_MM) * STEP_MM, STEP_MM / 12**0.5) == pytest.approx(STEP_MM)
    assert step_of(gap + rng.normal(0, 0.1, 150), 0.1) < 0.01
    assert step_of(gap, 0.01) == pytest.approx(0.01 * 12**0.5)
    assert step_of(gap, 0.0) == 0.0


def test_independent_errors_have_the_covariance_of_textbooks() -> None:
    """For white noise the covariance is sigma^2 (X'X)^-1, on average within a third of it in the SD."""
    rng, columns = np.random.default_rng(54), np.column_stack([np.ones(120), np.linspace(-1, 1, 120)])
    hat = columns @ np.linalg.pinv(columns)
    expected = 0.5 * np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    sds = []
    for _ in range(30):
        noise = rng.normal(0, 0.5, 120)
        covariance = covariance_of_fit(columns, noise - hat @ noise, np.ones(120), np.zeros(120))
        sds.append(np.sqrt(np.diag(covariance)))
    np.testing.assert_allclose(np.median(sds, axis=0), expected, rtol=1 / 3)


@pytest.mark.parametrize("drift_n", [0.01, -0.01])
def test_a_drift_that_is_seen_before_contact_is_taken_off(drift_n: float) -> None:
    """A zero that drifts by 0.01 N a sample would make 5 kPa read a quarter off; seen before contact, it does not."""
    rng = np.random.default_rng(55)
    found = [squeezed(5.0, rng, drift_n=drift_n, noise_n=0.1) for _ in range(40)]
    assert np.mean([each.modulus_kpa for each in found]) == pytest.approx(5.0, rel=0.03)
    assert 0.5 < np.std([in_sds(each, 5.0) for each in found]) < 1.3


def test_a_soft_beginning_is_no_drift() -> None:
    """Force that grows as the square of the way does not make a drift of what comes before it."""
    from palpate.estimators.forces import drift_before

    rng, gap = np.random.default_rng(56), np.linspace(75, 35, 200)
    for _ in range(20):
        force = 20 * (np.maximum(0, 55 - gap) / 20) ** 2 + rng.normal(0, 0.1, 200)
        assert drift_before(gap, force) == (0.0, 0.0)


@pytest.mark.parametrize("pace_mm", [0.2, STEP_MM, 0.353])
def test_without_noise_in_the_force_contact_is_found(pace_mm: float) -> None:
    """A force without noise tells of contact to the sample, and a gap in steps does not: they do not contradict."""
    rng = np.random.default_rng(57)
    for _ in range(60):
        found = squeezed(60.0, rng, pace_mm=pace_mm, noise_n=0.0)
        assert abs(in_sds(found, 60.0)) < 3.0


@pytest.mark.parametrize("cut", [0.8, 0.9])
def test_a_force_cut_off_at_the_end_is_noticed(cut: float) -> None:
    """A sensor that is at its end in the last tenth of the way would make the object softer than it is."""
    rng = np.random.default_rng(58)
    for _ in range(20):
        outcome = squeezed(40.0, rng, cut=cut).outcome
        assert isinstance(outcome, Failed)
        assert "stops growing" in outcome.reason


def test_a_few_samples_cut_off_are_left_out() -> None:
    """What is before them tells the modulus without bias."""
    rng, found = np.random.default_rng(59), []
    for _ in range(30):
        gap = 75 + rng.uniform(0, STEP_MM) - 0.2 * np.arange(200)
        force = 1.1 * np.maximum(0, 55 - gap) + rng.normal(0, 0.1, 200)
        force = np.minimum(force, force[-1] - 1.0)
        read = np.round(gap / STEP_MM) * STEP_MM
        found.append(squeeze(read, force, Jaws(AREA_MM2, WIDTH_MM)).modulus_kpa)
    assert np.mean(found) == pytest.approx(1.1e3 * WIDTH_MM / AREA_MM2, rel=0.005)
