"""Weighing: laws of the estimate, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.estimators.signals import EstimatorError
from palpate.estimators.weighing import Hold, weigh
from palpate.outcomes import Failed, Reading

GRAVITY = 9.80665


def hold(
    mass_kg: float,
    rng: np.random.Generator,
    *,
    lever_m: float = 0.45,
    offset_m: float = 0.0,
    per_offset: float = 1.0,
    noise_nm: float = 0.02,
    drift: float = 0.0,
    start_s: float = 0.0,
    zero_nm: float = 0.3,
) -> Hold:
    """A hold as physics has it, with white noise."""
    full_s = start_s + np.arange(50, dtype=np.float64) * 0.05
    empty_s = full_s + 5
    full = mass_kg * GRAVITY * (lever_m + per_offset * offset_m) + zero_nm + drift * full_s
    return Hold(
        full + rng.normal(0, noise_nm, 50),
        zero_nm + drift * empty_s + rng.normal(0, noise_nm, 50),
        lever_m,
        full_s,
        empty_s,
        per_offset,
    )


@given(st.floats(0.005, 3.0), st.floats(0.05, 1.0), st.floats(-5, 5))
def test_without_noise_the_mass_is_exact(mass_kg: float, lever_m: float, zero_nm: float) -> None:
    """tau = m g l + tau0 gives back m, whatever the lever and the zero."""
    ripple = 1e-9 * np.where(np.arange(50) % 2, -1.0, 1.0)
    full = np.full(50, mass_kg * GRAVITY * lever_m + zero_nm) + ripple
    found = weigh([Hold(full, np.full(50, zero_nm) + ripple, lever_m)], grasp_sd_m=0.0)
    assert found.mass_g == pytest.approx(1e3 * mass_kg, rel=1e-6)


def test_the_sd_is_that_of_the_errors() -> None:
    """Over many grasps and noises the error over its SD has mean zero and SD one, and 95 % lie within two."""
    rng = np.random.default_rng(3)
    scores = []
    for _ in range(1500):
        mass_kg = rng.uniform(0.02, 1)
        found = weigh([hold(mass_kg, rng, offset_m=rng.normal(0, 0.006))], grasp_sd_m=0.006)
        scores.append((found.mass_g - 1e3 * mass_kg) / found.sd_g)
    assert abs(np.mean(scores)) < 4 / np.sqrt(1500)
    assert 0.93 < np.std(scores) < 1.07
    assert 0.935 < np.mean(np.abs(scores) < 1.96) < 0.965


def test_correlated_noise_makes_the_sd_larger() -> None:
    """Noise that resembles itself from sample to sample tells less: errors are still covered."""
    rng = np.random.default_rng(4)
    scores = []
    for _ in range(600):
        noise = np.zeros((2, 200))
        for step in range(1, 200):
            noise[:, step] = 0.7 * noise[:, step - 1] + rng.normal(0, 0.02, 2)
        full, empty = noise + np.array([[0.25 * GRAVITY * 0.4], [0.0]])
        found = weigh([Hold(full, empty, 0.4)], grasp_sd_m=0.0)
        scores.append((found.mass_g - 250) / found.sd_g)
    assert 0.85 < np.std(scores) < 1.2


def test_few_samples_of_slow_noise_are_covered() -> None:
    """Of half a second of noise that lasts a fifth of one, correlation and scatter come out too small: not the SD."""
    rng, scores = np.random.default_rng(14), []
    for _ in range(400):
        noise = rng.normal(0, 0.0159, (2, 50))
        for step in range(1, 50):
            noise[:, step] = 0.9 * noise[:, step - 1] + np.sqrt(1 - 0.9**2) * noise[:, step]
        found = weigh([Hold(noise[0] + 0.25 * GRAVITY * 0.4, noise[1], 0.4)], grasp_sd_m=0.0)
        if isinstance(found.outcome, Reading):
            scores.append((found.mass_g - 250) / found.sd_g)
    assert len(scores) > 350
    assert 0.85 < np.std(scores) < 1.35


@pytest.mark.parametrize(
    ("second_nm", "lever_m", "per_offset", "told"),
    [(5.0, 0.45, 1.0, "no mass explains"), (5.0, 0.25, 0.5, "grasp is"), (-0.55, 0.25, 1.0, "grasp is")],
)
def test_joints_that_do_not_agree_fail(second_nm: float, lever_m: float, per_offset: float, told: str) -> None:
    """A joint with a wrong unit, lever or sign beside a right one: no mean of the two, no grasp half a metre off."""
    first, second, empty, other = np.random.default_rng(15).normal(0, 0.0159, (4, 50))
    outcome = weigh(
        [Hold(first + 0.5, empty, 0.45), Hold(second + second_nm, other, lever_m, lever_per_offset=per_offset)]
    ).outcome
    assert isinstance(outcome, Failed)
    assert told in outcome.reason


def test_poses_tell_the_offset_of_the_grasp() -> None:
    """Two poses whose levers change differently with the grasp leave less unknown than one, and are right about it."""
    rng = np.random.default_rng(5)
    one, two, scores = [], [], []
    for _ in range(300):
        offset_m = rng.normal(0, 0.006)
        level = hold(0.8, rng, offset_m=offset_m, noise_nm=0.003)
        tilted = hold(0.8, rng, offset_m=offset_m, noise_nm=0.003, lever_m=0.3, per_offset=-0.4, start_s=20)
        one.append(weigh([level]).sd_g)
        found = weigh([level, tilted])
        two.append(found.sd_g)
        scores.append((found.mass_g - 800) / found.sd_g)
    assert np.mean(two) < 0.5 * np.mean(one)
    assert 0.88 < np.std(scores) < 1.12


def test_drift_is_taken_off() -> None:
    """A zero that drifts biases the mass unless its drift is estimated."""
    rng = np.random.default_rng(6)
    biased, right = [], []
    for _ in range(200):
        holds = [
            hold(0.3, rng, drift=0.004),
            replace(hold(0.3, rng, drift=0.004, start_s=20, lever_m=0.2), lever_per_offset=0.5),
        ]
        biased.append(weigh(holds, grasp_sd_m=0.0).mass_g - 300)
        right.append(weigh(holds, grasp_sd_m=0.0, drifts=True).mass_g - 300)
    assert abs(np.mean(biased)) > 3
    assert abs(np.mean(right)) < 4 * np.std(right) / np.sqrt(200)


def test_noise_alone_is_no_mass() -> None:
    """Noise weighs nothing, give or take its SD: it is never a confident mass."""
    rng = np.random.default_rng(7)
    sure = 0
    for _ in range(500):
        outcome = weigh([Hold(rng.normal(0, 0.1, 50), rng.normal(0, 0.1, 50), 0.4)]).outcome
        sure += isinstance(outcome, Reading) and abs(outcome.value) > 3 * float(outcome.sd or 0)
    assert sure <= 8


@pytest.mark.parametrize(
    ("torque_nm", "told"),
    [
        ([], "0 samples, at least 5"),
        ([1.0, 2.0], "2 samples"),
        ([float("nan")] * 50, "50 of 50 samples are not finite"),
        ([1.0] * 50, "all 50 samples are 1"),
        ([3.0] * 30 + [1.0, 1.1, 1.2, 1.3] * 5, "cut off"),
        (list(np.repeat([2.0, 0.3], 25) + 0.01 * np.sin(np.arange(50))), "slipped or fell"),
        (list(-5.0 + 0.01 * np.sin(np.arange(50))), "below zero"),
    ],
)
def test_bad_torques_fail_with_the_reason(torque_nm: list[float], told: str) -> None:
    """Signals that cannot be right give a failed outcome that says why."""
    empty = np.random.default_rng(0).normal(0, 0.02, 50)
    outcome = weigh([Hold(np.array(torque_nm), empty, 0.4)]).outcome
    assert isinstance(outcome, Failed)
    assert told in outcome.reason


def test_a_step_below_the_resolution_is_no_slip() -> None:
    """A settling arm without noise steps by less than its sensors can tell; with finer sensors it is a slip."""
    settling = np.repeat([2.0, 2.0002], 25) + 1e-7 * np.sin(np.arange(50))
    hold = Hold(settling, np.zeros(50), 0.4)
    found = weigh([hold], grasp_sd_m=0.0)
    assert isinstance(found.outcome, Reading)
    assert found.mass_g == pytest.approx(2000.1 / (0.4 * GRAVITY), rel=1e-6)
    assert isinstance(weigh([hold], resolution_nm=1e-4).outcome, Failed)


def test_a_sensor_of_few_steps_is_not_cut_off() -> None:
    """Noise that a coarse sensor rounds to three levels still has a mean."""
    torque = np.round(np.random.default_rng(8).normal(2.0, 0.025, 60) / 0.05) * 0.05
    assert len(np.unique(torque)) == 3
    assert isinstance(weigh([Hold(torque, torque - 2.0, 0.4)]).outcome, Reading)


def test_wrong_calls_are_errors() -> None:
    """No hold, no lever, no stamps where they are needed, stamps of another length: one sentence each."""
    good = hold(0.2, np.random.default_rng(0))
    for holds, drifts, told in (
        ([], False, "found none"),
        ([replace(good, lever_m=0.0)], False, "lever_m"),
        ([replace(good, lever_m=450.0)], False, "found 450.0, expected 0.001 to 10 metres"),
        ([replace(good, time_s=None)], True, "time stamps"),
        ([replace(good, time_s=np.arange(3.0))], True, "different lengths"),
    ):
        with pytest.raises(EstimatorError, match=told):
            weigh(holds, drifts=drifts)


@pytest.mark.parametrize("wrong", [-1.0, float("nan"), float("inf")])
def test_numbers_that_cannot_be_are_errors(wrong: float) -> None:
    """An SD of the grasp below zero, or one that is no number, would else be taken for none: the SD too small."""
    good = hold(0.2, np.random.default_rng(0))
    with pytest.raises(EstimatorError, match="grasp_sd_m"):
        weigh([good], grasp_sd_m=wrong)
    with pytest.raises(EstimatorError, match="resolution_nm"):
        weigh([good], resolution_nm=wrong)
    if not np.isfinite(wrong):
        with pytest.raises(EstimatorError, match="lever_per_offset"):
            weigh([replace(good, lever_per_offset=wrong)])


def test_more_than_the_arm_can_hold_is_no_mass() -> None:
    """Torques in the wrong unit are refused, whatever arm it is; what it can just hold is weighed."""
    one = hold(0.112, np.random.default_rng(7))
    wrong = weigh([replace(one, torque_nm=1e3 * one.torque_nm, empty_torque_nm=1e3 * one.empty_torque_nm)]).outcome
    assert isinstance(wrong, Failed)
    assert "kg, and the arm can hold 4.5 kg: torques or levers are in another unit" in wrong.reason
    heavy = [hold(9.0, np.random.default_rng(7))]
    assert isinstance(weigh(heavy).outcome, Failed)
    assert isinstance(weigh(heavy, payload_kg=10.0).outcome, Reading)
    assert isinstance(weigh(heavy, payload_kg=float("inf")).outcome, Reading)
    for payload_kg in (0.0, -1.0, float("nan")):
        with pytest.raises(EstimatorError, match="payload_kg"):
            weigh(heavy, payload_kg=payload_kg)
