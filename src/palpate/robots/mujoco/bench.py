"""The bench: a scene with its noise, and what several actions share: grasping, and what can go wrong in it."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import Self

import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.camera import Camera
from palpate.robots.mujoco.furniture import PLACE_M
from palpate.robots.mujoco.gripper import FORCE_RANGE_N, STROKE_MM
from palpate.robots.mujoco.motion import Motion, reach
from palpate.robots.mujoco.noise import BenchNoise
from palpate.robots.mujoco.objects import BenchObject
from palpate.robots.mujoco.scene import Scene

__all__ = ["Bench", "Mishap"]

READY_M = (0.30, 0.0, 0.42)
"""Where the gripper waits: high, and out of the camera's view of the object."""
CLEARANCE_M = 0.03
GRIP_SHARE = 0.25
"""The gripper closes until its least force, or by this share of the width: so it neither drops nor crushes things."""
LEAST_GRIP_N = 1.0
Vector = NDArray[np.float64]


class Mishap(Enum):
    """What goes wrong with a grasp."""

    NONE = "none"
    MISS = "miss"
    DROP = "drop"
    SLIP = "slip"


class Bench:
    """An object on a table before an arm; each action begins with the object put back and the arm at rest.

    Parameters
    ----------
    thing
        The object on the table.
    rng
        The only source of chance.
    watch
        Called with the scene at each hundredth of a second of its time: for videos.

    Examples
    --------
    ::

        with Bench(thing, rng=np.random.default_rng(1)) as bench:
            signals = weigh(bench)
    """

    def __init__(
        self,
        thing: BenchObject,
        noise: BenchNoise | None = None,
        rng: np.random.Generator | None = None,
        watch: Callable[[Scene], None] | None = None,
    ) -> None:
        self.thing = thing
        self.noise = noise if noise is not None else BenchNoise()
        self.rng = rng if rng is not None else np.random.default_rng()
        self.scene = Scene(thing)
        self.motion = Motion(self.scene, watch)
        self.camera = Camera(self.scene)
        self.empty_torques_nm: Vector | None = None
        self._clock_s = 0.0
        self.scene.home_rad = reach(self.scene, np.array(READY_M))
        self.scene.reset()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the graphics; may be called twice."""
        self.camera.close()

    @property
    def clock_s(self) -> float:
        """Time [s] since the bench was set up; it goes on when the scene is reset."""
        return self._clock_s + float(self.scene.data.time)

    def wait(self, time_s: float) -> None:
        """Let time [s] pass in which nothing moves."""
        self._clock_s += time_s

    def reset(self) -> None:
        """Put the object back and the arm to rest."""
        self._clock_s = self.clock_s
        self.scene.reset()
        self.scene.set_friction(1.0)
        self.scene.let_tip_touch(False)
        self.scene.keep_force(None)
        self.scene.data.xfrc_applied[:] = 0.0

    def draw_mishap(self) -> Mishap:
        """What will go wrong this time."""
        noise = self.noise
        limits = np.cumsum([noise.miss_probability, noise.drop_probability, noise.slip_probability])
        place = int(np.searchsorted(limits, self.rng.random(), side="right"))
        return (Mishap.MISS, Mishap.DROP, Mishap.SLIP, Mishap.NONE)[place]

    def draw_grasp_m(self, mishap: Mishap) -> Vector:
        """Where the pads will meet the object: off along the pads, a little to one side, and far too high in a miss."""
        along = self.rng.uniform(-1, 1) * self.noise.grasp_offset_mm / 1e3
        aside = self.rng.normal() * self.noise.centring_sd_mm / 1e3
        room = (STROKE_MM - self.thing.grip_width_mm) / 2e3 - 5e-4
        up = self.thing.size_mm[2] / 1e3 + CLEARANCE_M if mishap is Mishap.MISS else self.thing.grip_height_mm / 1e3
        return np.array([PLACE_M[0] + along, PLACE_M[1] + np.clip(aside, -room, room), up])

    def approach(self, grasp_m: Vector, room_mm: float) -> Vector:
        """Bring the open gripper around the object; returns the arm's angles there."""
        above = grasp_m.copy()
        above[2] = max(grasp_m[2], self.thing.size_mm[2] / 1e3) + CLEARANCE_M
        there = reach(self.scene, grasp_m)
        self.motion.go(reach(self.scene, above))
        self.motion.set_gap(min(self.thing.grip_width_mm + room_mm, STROKE_MM))
        self.motion.go(there)
        self.motion.hold(there, 0.15)
        return there

    def close_gripper(self) -> None:
        """Close on the object, and keep the force: if it is lost, the fingers close altogether."""
        firm_mm = (1 - GRIP_SHARE) * self.thing.grip_width_mm
        self.motion.set_gap(firm_mm, 60.0, until=lambda scene: scene.grip_n >= FORCE_RANGE_N[0])
        self.motion.rest(0.1)
        self.scene.keep_force(max(self.scene.grip_n, LEAST_GRIP_N))
        self.motion.rest(0.1)
