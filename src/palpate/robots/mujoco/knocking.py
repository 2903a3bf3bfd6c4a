"""Knocking: the closed fingers tap the object, and a microphone hears it."""

from __future__ import annotations

import mujoco
import numpy as np

from palpate.robots.mujoco.bench import CLEARANCE_M, Bench
from palpate.robots.mujoco.furniture import PLACE_M
from palpate.robots.mujoco.gripper import PAD_TO_TIP_M
from palpate.robots.mujoco.hearing import BEFORE_S, DURATION_S, RATE_HZ, heard
from palpate.robots.mujoco.motion import reach
from palpate.robots.mujoco.scene import STEP_S, Scene
from palpate.robots.mujoco.sound import Knock
from palpate.robots.signals import SoundSignals

__all__ = ["BEFORE_S", "DURATION_S", "RATE_HZ", "knock"]

TAP_S, DEPTH_M = 0.25, 0.012
UP = np.array([0.0, 0.0, 1.0])
TOUCH_STEPS = 10
"""Time steps that count as the knock: afterwards the arm only leans on the object."""


def knock(bench: Bench) -> SoundSignals:
    """Tap the object's top from above, and hear it ring."""
    bench.reset()
    impulse = _tap(bench)
    struck = Knock(impulse, *bench.rng.uniform(0.15, 0.45, 2))
    thing = bench.thing
    sound = heard(thing.substance, thing.size_mm, thing.wall_mm, struck, bench.noise, bench.rng)
    return SoundSignals(sound, RATE_HZ, impulse)


def _tap(bench: Bench) -> float:
    """Impulse of the fingertip on the object [N s]."""
    scene, motion = bench.scene, bench.motion
    scene.let_tip_touch(True)
    along, aside = bench.thing.knock_mm
    top = np.array([PLACE_M[0] + along / 1e3, PLACE_M[1] + aside / 1e3, bench.thing.size_mm[2] / 1e3 + PAD_TO_TIP_M])
    above, below = reach(scene, top + CLEARANCE_M * UP), reach(scene, top - DEPTH_M * UP)
    motion.set_gap(0.0)
    motion.go(above)
    way = below - scene.angles_rad
    scene.data.ctrl[: len(below)] = way / TAP_S
    impulse, touched = 0.0, 0
    for _ in range(round(TAP_S / STEP_S)):
        scene.step(1)
        force = _tip_force_n(scene)
        impulse += force * STEP_S
        touched += force > 0 or touched > 0
        if touched >= TOUCH_STEPS:
            break
    motion.tick()
    motion.go(above)
    return impulse


def _tip_force_n(scene: Scene) -> float:
    """Normal force [N] between fingertip and object now."""
    tip, force, total = scene.model.geom("tip").id, np.zeros(6), 0.0
    for place in range(scene.data.ncon):
        contact = scene.data.contact[place]
        if tip in (contact.geom1, contact.geom2):
            mujoco.mj_contactForce(scene.model, scene.data, place, force)
            total += float(force[0])
    return total
