"""The whole bench as a MuJoCo model, and its data: where joints, motors, geoms and cameras are found."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.arm import HOME_RAD, LINKS, add_arm
from palpate.robots.mujoco.bodies import add_object
from palpate.robots.mujoco.furniture import add_furniture
from palpate.robots.mujoco.gripper import FORCE_RANGE_N, PAD_FRICTION, STROKE_MM, TIP_BIT, add_gripper
from palpate.robots.mujoco.objects import BenchObject

__all__ = ["GRAVITY_M_S2", "STEP_S", "Scene", "build"]

STEP_S, GRAVITY_M_S2 = 0.002, 9.80665
ARM = len(LINKS)
Vector = NDArray[np.float64]


def build(thing: BenchObject | None) -> mujoco.MjSpec:
    """Specification of the bench with an object on the table, or with an empty table."""
    spec = mujoco.MjSpec()
    spec.modelname = "bench"
    spec.compiler.degree = False
    option = spec.option
    option.timestep, option.gravity = STEP_S, [0, 0, -GRAVITY_M_S2]
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    # Friction holds an object for seconds without creeping only with elliptic cones, a hard
    # tangential direction, and a few sweeps that take the rest of the slip out.
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio, option.noslip_iterations = 10.0, 5
    add_furniture(spec)
    add_gripper(spec, add_arm(spec))
    if thing is not None:
        add_object(spec, thing)
    return spec


class Scene:
    """A compiled bench and its state.

    Parameters
    ----------
    thing
        What stands on the table; None leaves it empty.
    add
        Adds more to the specification before it is compiled.
    """

    def __init__(self, thing: BenchObject | None, add: Callable[[mujoco.MjSpec], None] | None = None) -> None:
        self.thing = thing
        spec = build(thing)
        if add is not None:
            add(spec)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.home_rad: Vector = np.array(HOME_RAD)
        self.reset()

    def reset(self) -> None:
        """Put the object back on the table, and the arm home with its gripper open."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:ARM] = self.home_rad
        mujoco.mj_forward(self.model, self.data)
        self.data.act[:ARM] = self.home_rad + self.sag_rad()

    @property
    def angles_rad(self) -> Vector:
        """Angles of the arm's joints, (7,)."""
        return np.array(self.data.qpos[:ARM])

    @property
    def torques_nm(self) -> Vector:
        """Torques of the arm's joints, (7,): what a sensor at each would read without noise."""
        return np.array(self.data.actuator_force[:ARM])

    @property
    def gap_mm(self) -> float:
        """Gap between the pads [mm]."""
        return STROKE_MM - 1e3 * float(self.data.qpos[ARM] + self.data.qpos[ARM + 1])

    @property
    def grip_n(self) -> float:
        """Force of the gripper's drive [N]: at rest, that on either pad."""
        return float(self.data.actuator_force[ARM])

    @property
    def grasp_m(self) -> Vector:
        """Where the middle between the pads is, (3,)."""
        return np.array(self.data.site("grasp").xpos)

    def sag_rad(self) -> Vector:
        """By how much the servos' set points must lie beyond the angles, so that arm and gripper do not sag."""
        stiffness = self.model.actuator_gainprm[:ARM, 0]
        return np.array(self.data.qfrc_bias[:ARM] / stiffness)

    def lag_rad(self, speed_rad_s: Vector) -> Vector:
        """By how much they must lie ahead, so that the arm does not lag behind while it moves."""
        stiffness, damping = self.model.actuator_gainprm[:ARM, 0], -self.model.actuator_biasprm[:ARM, 2]
        return np.asarray(damping / stiffness * speed_rad_s)

    def at(self, angles_rad: Vector) -> mujoco.MjData:
        """Where everything would be with the arm at these angles."""
        data = mujoco.MjData(self.model)
        data.qpos[:] = self.data.qpos
        data.qpos[:ARM] = angles_rad
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        return data

    def step(self, steps: int) -> None:
        """Let time pass."""
        mujoco.mj_step(self.model, self.data, steps)

    def let_tip_touch(self, touches: bool) -> None:
        """Whether the closed fingers' tip meets the object; while they grip, it does not."""
        outline = self.model.geom("outline").id
        # the engine looks at bodies first, and then at their geoms
        for bits, place in (
            (self.model.geom_conaffinity, outline),
            (self.model.body_conaffinity, self.model.geom_bodyid[outline]),
        ):
            bits[place] = bits[place] | TIP_BIT if touches else bits[place] & ~TIP_BIT

    def keep_force(self, force_n: float | None) -> None:
        """Let the gripper close with this force [N] whatever the gap; None lets it follow its set point again."""
        most = FORCE_RANGE_N[1] if force_n is None else force_n
        self.model.actuator_forcerange[ARM] = [-FORCE_RANGE_N[1], most]
        if force_n is not None:
            self.data.act[ARM] = STROKE_MM / 1e3

    def set_friction(self, share: float) -> None:
        """Make the pads as slippery as this share of their friction."""
        for name in ("left_pad", "right_pad", "near_plate", "far_plate"):
            self.model.geom(name).friction[:] = np.array(PAD_FRICTION) * max(share, 1e-3)
