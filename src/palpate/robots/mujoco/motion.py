"""Moving the arm: where its joints must go, how it gets there, and how it holds still."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.arm import LINKS
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.gripper import STROKE_MM
from palpate.robots.mujoco.scene import ARM, STEP_S, Scene

__all__ = ["TICK_S", "Motion", "reach"]

TICK_S = 0.01
STEPS = round(TICK_S / STEP_S)
# Of the published speed limits: nobody drives an arm at its limits beside a wineglass.
SPEED_SHARE = 0.8
PEAK = 1.875
"""Largest speed over mean speed of a movement of least jerk."""
TURNING = (0, 1, 3, 5, 6)
"""Joints that reach uses; the others keep the arm in a vertical plane, where weight turns joints 2, 4 and 6 only."""
DOWN = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
"""The gripper points down, its fingers close across the arm's reach."""
Vector = NDArray[np.float64]


def reach(scene: Scene, at_m: Vector, pitch_rad: float = 0.0) -> Vector:
    """Angles that bring the middle between the pads to a point, the gripper pointing down, or tilted outwards.

    Raises
    ------
    BenchError
        The arm does not reach it.
    """
    model, data = scene.model, mujoco.MjData(scene.model)
    data.qpos[:] = scene.data.qpos
    data.qpos[:ARM] = scene.home_rad
    azimuth = float(np.arctan2(at_m[1], at_m[0]))
    aim = _turn(azimuth, 2) @ _turn(-pitch_rad, 1) @ DOWN
    site = model.site("grasp").id
    place, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    limits = np.array([link.limit_rad or 2 * np.pi for link in LINKS])
    for _ in range(100):
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        now = data.site_xmat[site].reshape(3, 3)
        wrong = np.cross(now.T, aim.T).sum(axis=0) / 2
        error = np.concatenate([at_m - data.site_xpos[site], wrong])
        if np.abs(error).max() < 1e-7:
            found: Vector = np.array(data.qpos[:ARM])
            return found
        mujoco.mj_jacSite(model, data, place, turn, site)
        jacobian = np.vstack([place, turn])[:, TURNING]
        change = np.linalg.solve(jacobian.T @ jacobian + 1e-6 * np.eye(len(TURNING)), jacobian.T @ error)
        data.qpos[list(TURNING)] += np.clip(change, -0.3, 0.3)
        data.qpos[:ARM] = np.clip(data.qpos[:ARM], -limits, limits)
    told = ", ".join(f"{value:.3f}" for value in at_m)
    raise BenchError(f"the arm does not reach ({told}) m with its gripper pointing down; bring the object nearer")


def _turn(angle_rad: float, axis: int) -> NDArray[np.float64]:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    first, second = [place for place in range(3) if place != axis]
    turn = np.eye(3)
    turn[first, first] = turn[second, second] = c
    turn[first, second], turn[second, first] = -s, s
    return turn


class Motion:
    """Drives a scene's arm and gripper; every wait is a whole number of ticks.

    Parameters
    ----------
    watch
        Called at each tick: for videos, and for what happens at a set time.
    """

    def __init__(self, scene: Scene, watch: Callable[[Scene], None] | None = None) -> None:
        self.scene = scene
        self.watch = watch

    def tick(self, speed_rad_s: Vector | float = 0.0, closing_mm_s: float = 0.0) -> None:
        """Let one tick pass, while set points move at these speeds."""
        self.scene.data.ctrl[:ARM] = speed_rad_s
        self.scene.data.ctrl[ARM] = closing_mm_s / 1e3
        self.scene.step(STEPS)
        if self.watch:
            self.watch(self.scene)

    def go(self, target_rad: Vector) -> None:
        """Move all joints together with least jerk, none of them faster than its share of the published limit."""
        scene = self.scene
        start = scene.angles_rad
        way = target_rad - start
        limits = np.array([link.speed_rad_s for link in LINKS])
        duration = max(0.15, float((np.abs(way) / limits).max()) * PEAK / SPEED_SHARE)
        ticks = int(np.ceil(duration / TICK_S))
        x = np.arange(ticks + 1) / ticks
        places = start + np.outer(x**3 * (10 - 15 * x + 6 * x**2), way)
        speeds = np.outer(30 * (x * (1 - x)) ** 2 / (ticks * TICK_S), way)
        for count in range(ticks):
            ahead = places[count] + scene.lag_rad(speeds[count])
            after = places[count + 1] + scene.lag_rad(speeds[count + 1])
            scene.data.act[:ARM] = ahead + scene.sag_rad()
            self.tick((after - ahead) / TICK_S)
        scene.data.act[:ARM] = target_rad + scene.sag_rad()

    def hold(self, target_rad: Vector, wait_s: float, trim: float = 0.25) -> None:
        """Stay there, and shift the set points until the weight of what is held no longer bends the pose."""
        for _ in range(round(wait_s / TICK_S)):
            self.scene.data.act[:ARM] += trim * (target_rad - self.scene.angles_rad)
            self.tick()

    def rest(self, wait_s: float) -> None:
        """Wait with all set points as they are."""
        for _ in range(round(wait_s / TICK_S)):
            self.tick()

    def set_gap(self, gap_mm: float, speed_mm_s: float = 100.0, until: Callable[[Scene], bool] | None = None) -> None:
        """Drive the gripper to a gap at a speed, or until something is so."""
        way_mm = STROKE_MM - gap_mm - 1e3 * float(self.scene.data.act[ARM])
        ticks = max(1, int(np.ceil(abs(way_mm) / (speed_mm_s * TICK_S))))
        for _ in range(ticks):
            self.tick(closing_mm_s=way_mm / (ticks * TICK_S))
            if until is not None and until(self.scene):
                return
