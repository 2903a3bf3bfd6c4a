from dataclasses import replace

import numpy as np
import pytest

from palpate.robots.mujoco.noise import QUIET, BenchNoise
from palpate.robots.mujoco.squeezing import squeeze


def slope_n_per_mm(signals):
    """Force per way, where the pads touch for certain."""
    touched = signals.force_n > 0.25 * signals.force_n.max()
    return -np.polyfit(signals.gap_mm[touched], signals.force_n[touched], 1)[0]


@pytest.mark.parametrize("size", [(70.0, 50.0, 70.0), (70.0, 70.0, 70.0), (18.0, 40.0, 24.0)])
@pytest.mark.parametrize("elasticity", [5.0, 40.0, 150.0])
def test_stiffness_is_e_a_over_l(bench, elasticity: float, size) -> None:
    """Force grows with the way as E A / L says, A being what pad (22 x 37.5 mm) and object share: within 1.5 %."""
    with bench(elasticity_kpa=elasticity, size=size) as made:
        found = squeeze(made)
    area_mm2 = min(size[0], 22.0) * min(size[2], 37.5)
    assert found.contact_area_mm2 == pytest.approx(area_mm2)
    assert slope_n_per_mm(found) == pytest.approx(elasticity * 1e-3 * area_mm2 / size[1], rel=0.015)


def test_springs_give_way_as_they_are_pressed(block) -> None:
    """Pressed with a known force between its plates, a block is shorter by F L / (E A) at rest: within 1 %."""
    from palpate.robots.mujoco.scene import Scene

    scene = Scene(block(elasticity_kpa=60.0))
    scene.data.body("near").xfrc_applied[1], scene.data.body("far").xfrc_applied[1] = 6.0, -6.0
    scene.step(2000)
    way_m = scene.data.joint("near").qpos[0] + scene.data.joint("far").qpos[0]
    assert way_m == pytest.approx(6.0 * 0.060 / (60e3 * 22e-3 * 37.5e-3), rel=0.01)


def test_a_squeeze_begins_before_contact_and_ends_at_its_limits(bench) -> None:
    """First nothing is felt; a stiff object stops the gripper by force, a soft one after a third of its width."""
    with bench(elasticity_kpa=150.0) as stiff, bench(elasticity_kpa=5.0) as soft:
        hard, yielding = squeeze(stiff), squeeze(soft)
    for found in (hard, yielding):
        assert found.gap_mm[0] > 60.0
        assert np.abs(found.force_n[:10]).max() < 0.5
        assert np.all(np.diff(found.time_s) > 0)
    assert 20.0 <= hard.force_n[-1] < 25.0
    assert hard.gap_mm[-1] > 50.0
    assert yielding.gap_mm[-1] == pytest.approx(0.65 * 60.0, abs=1.0)


def test_the_position_comes_in_steps(bench) -> None:
    """With the gripper's resolution every gap is a whole number of steps of 0.37 mm from open; the register agrees."""
    with bench(replace(QUIET, position_step_mm=0.37)) as made:
        found = squeeze(made)
    steps = (85.0 - found.gap_mm) / 0.37
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    np.testing.assert_array_equal(np.round(steps), found.position_counts)


def test_force_is_as_noisy_as_it_should_be(bench) -> None:
    """Before contact the force scatters with its SD, and the rest width with its own."""
    with bench(replace(QUIET, force_sd_n=0.5, width_sd_mm=2.0)) as made:
        found = [squeeze(made) for _ in range(12)]
    assert np.concatenate([signals.force_n[:10] for signals in found]).std() == pytest.approx(0.5, rel=0.3)
    widths = [signals.rest_width_mm for signals in found]
    assert np.mean(widths) == pytest.approx(60.0, abs=2.0)
    assert 0.8 < np.std(widths) < 3.5


def test_a_miss_feels_nothing_and_a_slip_lets_go(bench, surely) -> None:
    """Closing above the object finds no force; when it pops out, the force is gone."""
    with bench(surely("miss")) as missed, bench(surely("slip")) as slipped:
        nothing, lost = squeeze(missed), squeeze(slipped)
    assert np.abs(nothing.force_n).max() < 0.5
    assert lost.force_n.max() > 1.0
    assert abs(lost.force_n[-1]) < 0.3


def test_the_object_stays_on_the_table(bench) -> None:
    """A soft object is supported while it is squeezed: it does not sink or rise."""
    with bench(elasticity_kpa=5.0, mass_g=30.0) as made:
        squeeze(made)
        assert made.scene.data.body("object").xpos[2] == pytest.approx(0.035, abs=1e-3)


def test_the_seed_decides_the_squeeze(bench) -> None:
    """The same seed gives the same samples, another one others."""
    found = []
    for seed in (5, 5, 6):
        with bench(BenchNoise(), seed=seed) as made:
            found.append(squeeze(made).force_n)
    np.testing.assert_array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])
