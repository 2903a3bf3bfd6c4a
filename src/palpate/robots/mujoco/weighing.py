"""Weighing: the torques of the joints while the object hangs from the gripper, and without it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.arm import LINKS
from palpate.robots.mujoco.bench import Bench, Mishap
from palpate.robots.mujoco.motion import TICK_S, reach
from palpate.robots.mujoco.scene import ARM, Scene
from palpate.robots.mujoco.signals import HoldSignals, WeighSignals

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
    gap_before = bench.scene.gap_mm
    held, held_s = _read(bench, pose, slips_at=SAMPLES // 2 if mishap is Mishap.SLIP else None)
    joints, levers, per_offset = _levers(bench.scene, pose)
    offset = bench.rng.normal(0, 1, ARM) * bench.noise.torque_offset_nm
    drift = bench.rng.normal(0, 1, ARM) * bench.noise.torque_drift_nm_per_s
    start = empty_s[0]
    holds = tuple(
        HoldSignals(
            joint=LINKS[joint].name,
            torque_nm=_noisy(bench, held[:, joint], offset[joint] + drift[joint] * (held_s - start)),
            time_s=held_s,
            empty_torque_nm=_noisy(bench, empty[:, joint], offset[joint] + drift[joint] * (empty_s - start)),
            empty_time_s=empty_s,
            lever_m=float(levers[joint]),
            lever_per_offset=float(per_offset[joint]),
        )
        for joint in joints
    )
    return WeighSignals(holds, (max(gap_before, 0.0), max(bench.scene.gap_mm, 0.0)))


def _empty_torques(bench: Bench, pose: Vector) -> Vector:
    """Torques without an object, (n, 7), each sample free of noise; physics repeats itself, so they are read once."""
    if bench.empty_torques_nm is None:
        bench.reset()
        bench.motion.go(pose)
        bench.motion.set_gap(0.0)
        bench.motion.hold(pose, SETTLE_S)
        bench.empty_torques_nm, _ = _read(bench, pose, slips_at=None)
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


def _read(bench: Bench, pose: Vector, slips_at: int | None) -> tuple[Vector, Vector]:
    """Torques, (n, 7), and their times while the pose is held with trimmed servos."""
    torques, times = np.empty((SAMPLES, ARM)), np.empty(SAMPLES)
    for count in range(SAMPLES):
        if count == slips_at:
            bench.scene.set_friction(0.0)
        bench.motion.hold(pose, TICK_S, trim=0.05)
        torques[count], times[count] = bench.scene.torques_nm, bench.clock_s
    return torques, times


def _levers(scene: Scene, pose: Vector) -> tuple[tuple[int, ...], Vector, Vector]:
    """Joints that a weight turns; for all, levers at the pose and their change with an offset along the pads."""
    placed = scene.at(pose)
    axes, anchors = placed.xaxis[:ARM], placed.xanchor[:ARM]
    site = placed.site("grasp")
    up, along = np.array([0.0, 0.0, 1.0]), site.xmat.reshape(3, 3)[:, 0]
    levers = np.einsum("ij,ij->i", axes, np.cross(site.xpos - anchors, up))
    per_offset = axes @ np.cross(along, up)
    joints = tuple(joint for joint in range(ARM) if abs(levers[joint]) >= LEAST_LEVER_M)
    return joints, levers, per_offset


def _noisy(bench: Bench, torque_nm: Vector, error_nm: Vector) -> Vector:
    return np.asarray(torque_nm + error_nm + bench.noise.torque_sd_nm * bench.rng.standard_normal(len(torque_nm)))
