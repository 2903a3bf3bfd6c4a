import numpy as np
import pytest

from palpate.robots.mujoco.arm import LINKS
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.motion import Motion, reach
from palpate.robots.mujoco.scene import ARM, Scene


@pytest.mark.parametrize("at_m", [(0.3, 0.0, 0.42), (0.46, 0.05, 0.03), (0.6, -0.1, 0.36)])
def test_reaching_brings_the_pads_to_the_point(at_m) -> None:
    """The middle between the pads is at the point, the gripper points down, and joints 3 and 5 stay in the plane."""
    scene = Scene(None)
    angles = reach(scene, np.array(at_m))
    site = scene.at(angles).site("grasp")
    np.testing.assert_allclose(site.xpos, at_m, atol=1e-6)
    np.testing.assert_allclose(site.xmat.reshape(3, 3)[:, 2], [0, 0, -1], atol=1e-6)
    np.testing.assert_allclose(angles[[2, 4]], scene.home_rad[[2, 4]])


def test_out_of_reach_is_an_error_that_says_so() -> None:
    """A point that the arm cannot reach is named."""
    with pytest.raises(BenchError, match=r"does not reach \(1\.500, 0\.000, 0\.300\) m"):
        reach(Scene(None), np.array([1.5, 0.0, 0.3]))


def test_movements_end_where_they_should_within_the_speed_limits() -> None:
    """A movement arrives within a milliradian, and no joint is ever faster than its published limit."""
    scene = Scene(None)
    speeds: list[np.ndarray] = []
    motion = Motion(scene, lambda scene: speeds.append(np.abs(scene.data.qvel[:ARM])))
    target = reach(scene, np.array([0.5, 0.1, 0.3]))
    motion.go(target)
    motion.hold(target, 0.3)
    np.testing.assert_allclose(scene.angles_rad, target, atol=1e-3)
    assert np.all(np.max(speeds, axis=0) <= [link.speed_rad_s for link in LINKS])


def test_the_gripper_opens_and_closes_over_its_stroke() -> None:
    """Gaps follow their set points to a tenth of a millimetre, and both fingers go the same way."""
    scene = Scene(None)
    motion = Motion(scene)
    assert scene.gap_mm == pytest.approx(85.0, abs=0.1)
    for gap_mm in (40.0, 0.0, 85.0):
        motion.set_gap(gap_mm)
        motion.rest(0.2)
        assert scene.gap_mm == pytest.approx(gap_mm, abs=0.1)
        assert scene.data.qpos[ARM] == pytest.approx(scene.data.qpos[ARM + 1], abs=1e-4)
