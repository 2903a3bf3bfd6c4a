import mujoco
import numpy as np
import pytest

from palpate.robots.mujoco.arm import BASE_MASS_KG, LINKS, TOOL_M
from palpate.robots.mujoco.scene import ARM, Scene


def test_the_arm_weighs_what_the_user_guide_says() -> None:
    """The links add up to the 8.2 kg that Kinova gives for the arm as a whole."""
    assert BASE_MASS_KG + sum(link.mass_kg for link in LINKS) == pytest.approx(8.2, abs=0.05)


def test_at_zero_the_arm_stands_straight_up() -> None:
    """With all angles zero the flange is as high as all published lengths together, and points up."""
    scene = Scene(None)
    data = scene.at(np.zeros(ARM))
    lengths = [0.15643, 0.12838, 0.21038, 0.21038, 0.20843, 0.10593, 0.10593, TOOL_M]
    flange = data.body("flange")
    assert flange.xpos[2] == pytest.approx(sum(lengths), abs=1e-9)
    assert abs(flange.xpos[0]) < 1e-9
    assert flange.xmat.reshape(3, 3)[2, 2] == pytest.approx(1.0)


def test_joints_stop_at_their_published_limits() -> None:
    """Ranges and torque limits of the model are those of the table."""
    model = Scene(None).model
    for place, link in enumerate(LINKS):
        assert bool(model.jnt_limited[place]) == (link.limit_rad is not None)
        if link.limit_rad is not None:
            np.testing.assert_allclose(model.jnt_range[place], [-link.limit_rad, link.limit_rad])
        np.testing.assert_allclose(model.actuator_forcerange[place], [-link.torque_nm, link.torque_nm])


def test_a_resting_arm_is_held_by_gravity_s_torques() -> None:
    """At rest the servos' torques are those of statics: of each link's weight at its centre of mass."""
    scene = Scene(None)
    scene.step(500)
    model, data = scene.model, scene.data
    expected = np.zeros(ARM)
    for body in range(model.nbody):
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jacBodyCom(model, data, jacobian, None, body)
        expected += jacobian[2, :ARM] * model.body_mass[body] * 9.80665
    np.testing.assert_allclose(scene.torques_nm, expected, atol=0.02)
    assert np.abs(expected).max() > 5
