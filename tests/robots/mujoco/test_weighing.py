from dataclasses import replace

import numpy as np
import pytest

from palpate.robots.mujoco.bench import Mishap
from palpate.robots.mujoco.noise import QUIET, BenchNoise
from palpate.robots.mujoco.weighing import POSE_M, weigh

G_M_S2 = 9.80665


def weight_nm(hold):
    return hold.torque_nm.mean() - hold.empty_torque_nm.mean()


def mass_g(signals):
    """Mass, whatever the offset of the grasp: two joints, two unknowns."""
    rows = [[G_M_S2 * hold.lever_m, G_M_S2 * hold.lever_per_offset] for hold in signals.holds]
    return 1e3 * np.linalg.solve(rows, [weight_nm(hold) for hold in signals.holds])[0]


@pytest.mark.parametrize("mass", [20.0, 250.0, 1000.0])
def test_the_shoulder_carries_m_g_l(bench, mass: float) -> None:
    """Held still, the shoulder's torque is the weight times its horizontal distance, 0.6 m: to 0.2 %."""
    with bench(mass_g=mass, elasticity_kpa=100.0) as made:
        shoulder, elbow = weigh(made).holds
    assert shoulder.joint == "half_arm_1"
    assert abs(shoulder.lever_m) == pytest.approx(POSE_M[0], abs=1e-3)
    assert abs(weight_nm(shoulder)) == pytest.approx(mass / 1e3 * G_M_S2 * 0.6, rel=2e-3)
    assert abs(weight_nm(elbow)) == pytest.approx(mass / 1e3 * G_M_S2 * abs(elbow.lever_m), rel=2e-3)


@pytest.mark.parametrize("mass", [20.0, 1000.0])
def test_mass_does_not_depend_on_where_it_is_grasped(bench, mass: float) -> None:
    """With grasps off by up to 10 mm, levers and their changes tell the mass to half a gram."""
    with bench(replace(QUIET, grasp_offset_mm=10.0), mass_g=mass, elasticity_kpa=100.0) as made:
        found = [weigh(made) for _ in range(3)]
    torques = [weight_nm(signals.holds[0]) for signals in found]
    assert np.ptp(torques) > 1e-3 * mass / 1e3 * G_M_S2
    np.testing.assert_allclose([mass_g(signals) for signals in found], mass, atol=0.5)


def test_the_hold_does_not_creep(bench) -> None:
    """A kilogram held for half a second changes the torques by less than one gram would."""
    with bench(mass_g=1000.0, elasticity_kpa=100.0) as made:
        for hold in weigh(made).holds:
            assert np.ptp(hold.torque_nm) < 1e-3 * G_M_S2 * abs(hold.lever_m)


def test_samples_scatter_as_in_the_recorded_session(bench) -> None:
    """Samples of the elbow, read as masses, have an SD of 5.3 g, and different weighings have different noise."""
    with bench(replace(QUIET, torque_sd_nm=BenchNoise().torque_sd_nm)) as made:
        elbows = [weigh(made).holds[1] for _ in range(8)]
    samples = np.concatenate([hold.torque_nm - hold.torque_nm.mean() for hold in elbows])
    assert 1e3 * samples.std() / (G_M_S2 * abs(elbows[0].lever_m)) == pytest.approx(5.3, rel=0.12)
    assert not np.array_equal(elbows[0].torque_nm, elbows[1].torque_nm)


def test_times_are_on_one_clock(bench) -> None:
    """Time stamps rise, the empty gripper's first, and go on from one weighing to the next."""
    with bench() as made:
        first, second = weigh(made).holds[0], weigh(made).holds[0]
    for hold in (first, second):
        times = np.concatenate([hold.empty_time_s, hold.time_s])
        assert np.all(np.diff(times) > 0)
    assert second.empty_time_s[0] > first.time_s[-1]


def test_what_is_missed_or_dropped_leaves_nothing_between_the_fingers(bench, surely) -> None:
    """After a miss or a drop the gap closes and no weight is felt; in a good grasp there is something."""
    for mishap in ("miss", "drop"):
        with bench(surely(mishap)) as made:
            signals = weigh(made)
        assert not signals.holds_something
        assert mass_g(signals) == pytest.approx(0.0, abs=0.5)
    with bench() as made:
        assert weigh(made).holds_something


def test_what_slips_steps(bench, surely) -> None:
    """In a slip the torque falls in the middle of the hold by the whole weight, and the fingers close."""
    with bench(surely("slip")) as made:
        signals = weigh(made)
    torque = signals.holds[0].torque_nm
    assert abs(torque[:20].mean() - torque[-10:].mean()) == pytest.approx(0.2 * G_M_S2 * 0.6, rel=0.1)
    assert not signals.holds_something


def test_mishaps_come_at_their_rates(bench) -> None:
    """Misses, drops and slips are drawn as often as their probabilities say."""
    noise = replace(QUIET, miss_probability=0.2, drop_probability=0.1, slip_probability=0.05)
    with bench(noise) as made:
        drawn = [made.draw_mishap() for _ in range(4000)]
    for mishap, probability in ((Mishap.MISS, 0.2), (Mishap.DROP, 0.1), (Mishap.SLIP, 0.05), (Mishap.NONE, 0.65)):
        sd = np.sqrt(probability * (1 - probability) / 4000)
        assert drawn.count(mishap) / 4000 == pytest.approx(probability, abs=4.5 * sd)


def test_the_seed_decides_everything(bench) -> None:
    """Two benches with one seed give the same samples to the last digit, another seed gives others."""
    found = []
    for seed in (3, 3, 4):
        with bench(BenchNoise(), seed=seed) as made:
            found.append(weigh(made).holds[0].torque_nm)
    np.testing.assert_array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])
