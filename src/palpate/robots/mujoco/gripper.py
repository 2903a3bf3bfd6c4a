"""A parallel gripper like Robotiq's 2F-85: one drive closes two fingers by the same way.

Stroke, force, speed and mass are those of the instruction manual of the 2F-85 ("Specifications"): 85 mm, 20 to 235 N,
20 to 150 mm/s, 0.9 kg. The fingers of the real one swing on linkages; these slide. Lengths are assumed.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = [
    "FORCE_RANGE_N",
    "NEWTON_PER_AMPERE",
    "PAD_BIT",
    "PAD_FRICTION",
    "PAD_MM",
    "PAD_SOLIMP",
    "PAD_SOLREF",
    "PAD_TO_TIP_M",
    "PALM_TO_PAD_M",
    "POSITION_STEP_MM",
    "STROKE_MM",
    "TIP_BIT",
    "add_gripper",
    "gap_read_mm",
    "position_counts",
]

STROKE_MM = 85.0
FORCE_RANGE_N = (20.0, 235.0)
# The position register runs from 3 (open) to 230 (closed) over the stroke: 85 mm / 230 counts.
POSITION_STEP_MM = 0.37
NEWTON_PER_AMPERE = 235.0
"""Force of the drive by its motor's current: assumed, full force at 1 A."""
MASS_KG, FINGER_KG = 0.925, 0.08
PAD_MM = (22.0, 37.5)
"""Width and height of a pad: assumed."""
PALM_TO_PAD_M, PAD_TO_TIP_M = 0.130, 0.022

PAD_FRICTION = [1.0, 0.01, 0.0001]
"""Rubber on most things, and a little against turning on the spot: assumed."""
# Hard: an object gives way by its springs and not by its contacts, to 1 % at 150 kPa.
PAD_SOLREF, PAD_SOLIMP = [0.004, 1.0], [0.98, 0.995, 0.001, 0.5, 2.0]
PAD_BIT, TIP_BIT = 4, 8
"""Bits of `contype`: pads touch only the plates of an object, the tip only what is knocked at."""


def position_counts(gap_mm: NDArray[np.float64]) -> NDArray[np.int64]:
    """The position register at gaps, (n): 0 open.

    Examples
    --------
    >>> position_counts(np.array([85.0, 84.0, 0.0]))
    array([  0,   3, 230])
    """
    return np.round((STROKE_MM - gap_mm) / POSITION_STEP_MM).astype(np.int64)


def gap_read_mm(gap_mm: NDArray[np.float64], step_mm: float) -> NDArray[np.float64]:
    """Gaps [mm] as a register of this step [mm] tells them, (n); a step of 0 is none.

    Examples
    --------
    >>> gap_read_mm(np.array([85.0, 84.0]), 0.5)
    array([85., 84.])
    """
    return STROKE_MM - np.round((STROKE_MM - gap_mm) / step_mm) * step_mm if step_mm > 0 else gap_mm


def add_gripper(spec: mujoco.MjSpec, flange: mujoco.MjsBody) -> None:
    """Add the gripper to the flange: joints `left` and `right`, drive `grip`, site `grasp` between the pads."""
    palm = flange.add_body(name="palm")
    palm.mass, palm.ipos = MASS_KG - 2 * FINGER_KG, [0, 0, 0.045]
    palm.inertia, palm.explicitinertial = [0.0012, 0.0012, 0.0005], True
    _clothe_palm(palm)
    palm.add_site(name="grasp", pos=[0, 0, PALM_TO_PAD_M], size=[0.004, 0, 0], group=4)
    for name, side in (("left", 1.0), ("right", -1.0)):
        _add_finger(palm, name, side)
    # both fingers go the same way
    same = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT, name1="left", name2="right", objtype=mujoco.mjtObj.mjOBJ_JOINT
    )
    same.data[:5] = [0, 1, 0, 0, 0]
    same.solref, same.solimp = [0.004, 1.0], [0.99, 0.999, 0.001, 0.5, 2]
    # the length of the tendon is by how much the gap has closed, so its force is that on either pad
    closing = spec.add_tendon(name="closing")
    closing.wrap_joint("left", 1.0)
    closing.wrap_joint("right", 1.0)
    drive = spec.add_actuator(name="grip", target="closing", trntype=mujoco.mjtTrn.mjTRN_TENDON)
    drive.set_to_intvelocity(kp=20000.0, kv=400.0)
    drive.forcelimited, drive.forcerange = mujoco.mjtLimited.mjLIMITED_TRUE, [-FORCE_RANGE_N[1], FORCE_RANGE_N[1]]


def _add_finger(palm: mujoco.MjsBody, name: str, side: float) -> None:
    half_stroke = STROKE_MM / 2e3
    finger = palm.add_body(name=name, pos=[0, side * half_stroke, PALM_TO_PAD_M])
    finger.mass, finger.ipos = FINGER_KG, [0, side * 0.012, -0.025]
    finger.inertia, finger.explicitinertial = [8e-5, 6e-5, 3e-5], True
    joint = finger.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, -side, 0])
    joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, [0, half_stroke]
    joint.armature, joint.damping = 0.2, [5.0, 0, 0]  # the drive's screw: assumed
    width, height = (size / 2e3 for size in PAD_MM)
    pad = finger.add_geom(name=f"{name}_pad", type=mujoco.mjtGeom.mjGEOM_BOX, material="rubber")
    pad.size, pad.pos = [width, 0.004, height], [0, side * 0.004, 0]
    pad.contype, pad.conaffinity, pad.mass, pad.group = PAD_BIT, 0, 0.0, 1
    pad.condim, pad.friction = 4, PAD_FRICTION
    pad.solref, pad.solimp = PAD_SOLREF, PAD_SOLIMP
    _look(finger, mujoco.mjtGeom.mjGEOM_BOX, "black", [0.011, 0.005, 0.028], [0, side * 0.012, -0.004])
    bar = _look(finger, mujoco.mjtGeom.mjGEOM_CAPSULE, "ring", [0.008, 0, 0])
    bar.fromto = [0, side * 0.018, 0.008, 0, side * 0.018, -0.052]
    lever = _look(finger, mujoco.mjtGeom.mjGEOM_CAPSULE, "black", [0.007, 0, 0])
    lever.fromto = [0, side * 0.018, -0.026, 0, side * 0.004, -0.075]
    for depth in (-0.052, -0.026):
        pin = _look(finger, mujoco.mjtGeom.mjGEOM_CYLINDER, "shell", [0.004, 0.0125, 0], [0, side * 0.018, depth])
        pin.quat = [0.70710678, 0, 0.70710678, 0]


def _clothe_palm(palm: mujoco.MjsBody) -> None:
    _look(palm, mujoco.mjtGeom.mjGEOM_CYLINDER, "ring", [0.0375, 0.007, 0], [0, 0, 0.007])
    _look(palm, mujoco.mjtGeom.mjGEOM_CYLINDER, "black", [0.036, 0.022, 0], [0, 0, 0.034])
    _look(palm, mujoco.mjtGeom.mjGEOM_BOX, "black", [0.020, 0.062, 0.012], [0, 0, 0.060])
    for side in (1.0, -1.0):
        end = _look(palm, mujoco.mjtGeom.mjGEOM_CYLINDER, "black", [0.012, 0.020, 0], [0, side * 0.062, 0.060])
        end.quat = [0.70710678, 0, 0.70710678, 0]
    _look(palm, mujoco.mjtGeom.mjGEOM_BOX, "shell", [0.0205, 0.022, 0.004], [0, 0, 0.062])
    tip = palm.add_geom(name="tip", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.006, 0, 0])
    tip.pos, tip.rgba, tip.mass = [0, 0, PALM_TO_PAD_M + PAD_TO_TIP_M - 0.006], [0, 0, 0, 0], 0.0
    tip.contype, tip.conaffinity, tip.group = TIP_BIT, 0, 4


def _look(
    body: mujoco.MjsBody,
    kind: mujoco.mjtGeom,
    material: str,
    size: list[float],
    pos: list[float] | None = None,
) -> mujoco.MjsGeom:
    geom = body.add_geom(type=kind, material=material, size=size, pos=pos or [0, 0, 0])
    geom.contype = geom.conaffinity = 0
    geom.mass, geom.group = 0.0, 1
    return geom
