"""Weighing: the torques of the joints while the object hangs from the gripper, and without it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.arm import LINKS
from palpate.robots.mujoco.bench import Bench, Mishap
from palpate.robots.mujoco.gripper import NEWTON_PER_AMPERE, gap_read_mm, position_counts
from palpate.robots.mujoco.motion import TICK_S, reach
from palpate.robots.mujoco.scene import ARM, Scene
from palpate.robots.signals import GripperSamples, HoldSignals, WeighSignals

__all__ = ["POSE_M", "SAMPLES", "weigh"]

POSE_M = (0.60, 0.0, 0.36)
"""Where the grasp is while weighing; the arm's length decides how much a gram turns its joints."""
SAMPLES = 50
LEAST_LEVER_M = 0.05
SETTLE_S = 1.0
Vector = NDArray[np.float64]


def weigh(bench: Bench) -> WeighSignals:
    """Grasp, lift to the weighing pose, hold, and read the torques.

    Those of the empty, closed gripper at the same pose are read before the first weighing.
    """
    pose = reach(bench.scene, np.array(POSE_M))
    empty = _empty_torques(bench, pose)
    empty_s: Vector = np.asarray(bench.clock_s + TICK_S * np.arange(1, SAMPLES + 1))
    bench.wait(TICK_S * SAMPLES)
    mishap = bench.draw_mishap()
    bench.reset()
    _lift(bench, pose, mishap)
    held = _read(bench, pose, slips_at=SAMPLES // 2 if mishap is Mishap.SLIP else None)
    sensors = _Sensors.of(bench, pose, held, empty, empty_s)
    # what is only kept has noise of its own, so that it does not change what is measured next
    aside = bench.rng.spawn(1)[0]
    turned = [abs(lever) >= LEAST_LEVER_M for lever in sensors.lever_m]
    holds = tuple(sensors.hold(joint, bench.rng) for joint in range(ARM) if turned[joint])
    others = tuple(sensors.hold(joint, aside) for joint in range(ARM) if not turned[joint])
    gripper = _gripper(bench, held, aside)
    first, last = float(gripper.gap_mm[0]), float(gripper.gap_mm[-1])
    return WeighSignals(holds, (max(first, 0.0), max(last, 0.0)), others, gripper)


@dataclass(frozen=True, eq=False)
class _Held:
    """What there was to read while a pose was held, free of noise; samples (n,) and (n, 7)."""

    time_s: Vector
    torque_nm: Vector
    angle_rad: Vector
    gap_mm: Vector
    force_n: Vector


@dataclass(frozen=True, eq=False)
class _Sensors:
    """The joints' torque sensors in one weighing: what there is to read, and their errors."""

    held: _Held
    empty_nm: Vector
    empty_s: Vector
    lever_m: Vector
    per_offset: Vector
    offset_nm: Vector
    drift_nm_per_s: Vector
    noise_sd_nm: float

    @classmethod
    def of(cls, bench: Bench, pose: Vector, held: _Held, empty_nm: Vector, empty_s: Vector) -> _Sensors:
        """Draw the errors of this weighing."""
        noise, rng = bench.noise, bench.rng
        offset = rng.normal(0, 1, ARM) * noise.torque_offset_nm
        drift = rng.normal(0, 1, ARM) * noise.torque_drift_nm_per_s
        return cls(held, empty_nm, empty_s, *_levers(bench.scene, pose), offset, drift, noise.torque_sd_nm)

    def hold(self, joint: int, rng: np.random.Generator) -> HoldSignals:
        """What the sensor of a joint gives."""
        held = self.held
        return HoldSignals(
            joint=LINKS[joint].name,
            torque_nm=self._read(joint, held.torque_nm, held.time_s, rng),
            time_s=held.time_s,
            empty_torque_nm=self._read(joint, self.empty_nm, self.empty_s, rng),
            empty_time_s=self.empty_s,
            lever_m=float(self.lever_m[joint]),
            lever_per_offset=float(self.per_offset[joint]),
            angle_rad=held.angle_rad[:, joint],
        )

    def _read(self, joint: int, torques_nm: Vector, time_s: Vector, rng: np.random.Generator) -> Vector:
        error_nm = self.offset_nm[joint] + self.drift_nm_per_s[joint] * (time_s - self.empty_s[0])
        return _noisy(torques_nm[:, joint] + error_nm, self.noise_sd_nm, rng)


def _gripper(bench: Bench, held: _Held, rng: np.random.Generator) -> GripperSamples:
    force_n = _noisy(held.force_n, bench.noise.force_sd_n, rng)
    read_mm = gap_read_mm(held.gap_mm, bench.noise.position_step_mm)
    return GripperSamples(held.time_s, read_mm, force_n, position_counts(held.gap_mm), force_n / NEWTON_PER_AMPERE)


def _empty_torques(bench: Bench, pose: Vector) -> Vector:
    """Torques without an object, (n, 7), each sample free of noise; physics repeats itself, so they are read once."""
    if bench.empty_torques_nm is None:
        bench.reset()
        bench.motion.go(pose)
        bench.motion.set_gap(0.0)
        bench.motion.hold(pose, SETTLE_S)
        bench.empty_torques_nm = _read(bench, pose, slips_at=None).torque_nm
    return bench.empty_torques_nm


def _lift(bench: Bench, pose: Vector, mishap: Mishap) -> None:
    grasp = bench.draw_grasp_m(mishap)
    bench.approach(grasp, room_mm=10.0)
    bench.close_gripper()
    up = reach(bench.scene, np.array([grasp[0], grasp[1], max(grasp[2], POSE_M[2])]))
    bench.motion.go(up)
    if mishap is Mishap.DROP:
        bench.scene.set_friction(0.0)
    bench.motion.go(pose)
    bench.motion.hold(pose, SETTLE_S)


def _read(bench: Bench, pose: Vector, slips_at: int | None) -> _Held:
    """Read all sensors at each tick while the pose is held with trimmed servos."""
    scene, rows = bench.scene, []
    for count in range(SAMPLES):
        if count == slips_at:
            scene.set_friction(0.0)
        bench.motion.hold(pose, TICK_S, trim=0.05)
        rows.append((bench.clock_s, scene.torques_nm, scene.angles_rad, scene.gap_mm, scene.grip_n))
    return _Held(*(np.array(column) for column in zip(*rows, strict=True)))


def _levers(scene: Scene, pose: Vector) -> tuple[Vector, Vector]:
    """Levers of all joints at the pose, (7,), and their change with an offset along the pads."""
    placed = scene.at(pose)
    axes, anchors = placed.xaxis[:ARM], placed.xanchor[:ARM]
    site = placed.site("grasp")
    up, along = np.array([0.0, 0.0, 1.0]), site.xmat.reshape(3, 3)[:, 0]
    levers = np.einsum("ij,ij->i", axes, np.cross(site.xpos - anchors, up))
    per_offset = axes @ np.cross(along, up)
    return levers, per_offset


def _noisy(values: Vector, noise_sd: float, rng: np.random.Generator) -> Vector:
    return np.asarray(values + noise_sd * rng.standard_normal(len(values)))
