"""Squeezing: the gripper closes step by step on the object as it stands on the table, and reads force and gap."""

from __future__ import annotations

import numpy as np

from palpate.robots.mujoco.bench import Bench, Mishap
from palpate.robots.mujoco.gripper import (
    FORCE_RANGE_N,
    NEWTON_PER_AMPERE,
    POSITION_STEP_MM,
    STROKE_MM,
    gap_read_mm,
    position_counts,
)
from palpate.robots.mujoco.motion import TICK_S
from palpate.robots.mujoco.scene import GRAVITY_M_S2
from palpate.robots.signals import SqueezeSignals

__all__ = ["squeeze"]

ROOM_MM = 7.0
"""How much wider than the object the gripper is at most when it begins to close, and less by a part of a step."""
RUN_UP_STEPS = 3
"""Steps that are not recorded: the drive's own inertia would be felt in them."""
MOST_STRAIN = 0.35
TICKS_A_STEP = 2
"""A position step each fiftieth of a second: 18 mm/s, about the slowest that the gripper can do."""
PUSH_N = 2.0


def squeeze(bench: Bench) -> SqueezeSignals:
    """Close on the object until the gripper's least force or a third of its width."""
    mishap = bench.draw_mishap()
    bench.reset()
    grasp = bench.draw_grasp_m(mishap)
    width = bench.thing.grip_width_mm
    # jaws that always began at the same place of a step would err by the same each time
    room = min(ROOM_MM, STROKE_MM - width) - bench.rng.uniform(0.0, POSITION_STEP_MM)
    bench.approach(grasp, room)
    bench.motion.rest(0.1)
    rest_width = width + bench.noise.width_sd_mm * bench.rng.standard_normal()
    slips_at = width * (1 - bench.rng.uniform(0.05, 0.2)) if mishap is Mishap.SLIP else -1.0
    rows = _close(bench, slips_at)
    times, gaps, forces = np.array(rows).T
    gain = np.exp(bench.noise.force_gain_sd * bench.rng.standard_normal())
    forces = gain * forces + bench.noise.force_sd_n * bench.rng.standard_normal(len(forces))
    return SqueezeSignals(
        times,
        gap_read_mm(gaps, bench.noise.position_step_mm),
        forces,
        position_counts(gaps),
        bench.thing.contact_area_mm2,
        float(rest_width),
        forces / NEWTON_PER_AMPERE,
    )


def _close(bench: Bench, slips_at_mm: float) -> list[tuple[float, float, float]]:
    """Time [s], gap [mm] and force [N] at each step."""
    scene, motion = bench.scene, bench.motion
    rows = []
    least_gap = max((1 - MOST_STRAIN) * bench.thing.grip_width_mm, POSITION_STEP_MM)
    steps = int((scene.gap_mm - least_gap) / POSITION_STEP_MM)
    for step in range(steps):
        for _ in range(TICKS_A_STEP):
            motion.tick(closing_mm_s=POSITION_STEP_MM / (TICKS_A_STEP * TICK_S))
        if step >= RUN_UP_STEPS:
            rows.append((bench.clock_s, scene.gap_mm, scene.grip_n))
        if scene.gap_mm < slips_at_mm:
            # it pops out along the pads
            scene.set_friction(0.0)
            scene.data.body("object").xfrc_applied[0] = PUSH_N + 1e-3 * GRAVITY_M_S2 * bench.thing.mass_g
        if scene.grip_n >= FORCE_RANGE_N[0]:
            break
    return rows
