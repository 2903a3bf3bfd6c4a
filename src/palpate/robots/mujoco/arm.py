"""A 7-DoF arm like Kinova's Gen3, from published figures and simple shapes.

Frames, masses, inertia, joint limits and torque limits are those of Kinova's Gen3 user guide ("Dynamic parameters of
the 7 DoF robot", "Actuators"), in the digits in which Kinova publishes them for ROS (package kortex_description, arm
gen3, 7 DoF, with vision module). Shapes, the servos' gains and the rotors' inertia are this project's own: assumed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import mujoco
import numpy as np

__all__ = ["BASE_MASS_KG", "HOME_RAD", "LINKS", "TOOL_M", "Link", "add_arm"]

SHELL, RING, BLACK = "shell", "ring", "black"
"""Materials of the bench's furniture."""


@dataclass(frozen=True)
class Link:
    """A link with the joint that carries it; the joint turns about the link's z axis.

    Attributes
    ----------
    origin_m, roll_rad
        Where the frame lies in that of the link before, and its rotation about x.
    centre_m, inertia_kgm2
        Centre of mass, and moments about it: xx, yy, zz, xy, xz, yz.
    limit_rad
        Largest angle either way; None where the joint turns for ever.
    torque_nm, speed_rad_s
        Limits of the joint.
    radius_m
        Of the shape.
    """

    name: str
    origin_m: tuple[float, float, float]
    roll_rad: float
    mass_kg: float
    centre_m: tuple[float, float, float]
    inertia_kgm2: tuple[float, float, float, float, float, float]
    limit_rad: float | None
    torque_nm: float
    speed_rad_s: float
    radius_m: float


BASE_MASS_KG = 1.697
TOOL_M = 0.061525  # from the last joint's frame to the flange, along -z

LINKS = (
    Link("shoulder", (0, 0, 0.15643), pi, 1.3773, (-2.3e-5, -0.010364, -0.07336),
         (0.00457, 0.004831, 0.001409, 1e-6, 2e-6, 0.000448), None, 39.0, 1.3963, 0.046),
    Link("half_arm_1", (0, 0.005375, -0.12838), pi / 2, 1.1636, (-4.4e-5, -0.09958, -0.013278),
         (0.011088, 0.001072, 0.011255, 5e-6, 0, -0.000691), 2.41, 39.0, 1.3963, 0.045),
    Link("half_arm_2", (0, -0.21038, -0.006375), -pi / 2, 1.1636, (-4.4e-5, -0.006641, -0.117892),
         (0.010932, 0.011127, 0.001043, 0, -7e-6, 0.000606), None, 39.0, 1.3963, 0.044),
    Link("forearm", (0, 0.006375, -0.21038), pi / 2, 0.9302, (-1.8e-5, -0.075478, -0.015006),
         (0.008147, 0.000631, 0.008316, -1e-6, 0, -0.0005), 2.66, 39.0, 1.3963, 0.042),
    Link("wrist_1", (0, -0.20843, -0.006375), -pi / 2, 0.6781, (1e-6, -0.009432, -0.063883),
         (0.001596, 0.001607, 0.000399, 0, 0, 0.000256), None, 9.0, 1.2218, 0.036),
    Link("wrist_2", (0, 0.00017505, -0.10593), pi / 2, 0.6781, (1e-6, -0.045483, -0.00965),
         (0.001641, 0.00041, 0.001641, 0, 0, -0.000278), 2.23, 9.0, 1.2218, 0.035),
    Link("bracelet", (0, -0.10593, -0.00017505), -pi / 2, 0.5, (0.000281, 0.011402, -0.029798),
         (0.000587, 0.000369, 0.000609, 3e-6, 3e-6, -0.000118), None, 9.0, 1.2218, 0.034),
)  # fmt: skip

HOME_RAD = (0.0, 0.262, pi, -2.269, 0.0, 0.960, pi / 2)
"""The user guide's home position: 0, 15, 180, 230, 0, 55 and 90 degrees."""


def add_arm(spec: mujoco.MjSpec) -> mujoco.MjsBody:
    """Add the arm with its position servos at the origin, and return the flange; z points out of it."""
    base = spec.worldbody.add_body(name="base")
    _cylinder(base, 0.062, 0.006, (0, 0, 0.006), BLACK)
    _capsule(base, (0, 0, 0.035), (0, 0, 0.13), 0.050, SHELL)
    _cylinder(base, 0.052, 0.016, (0, 0, 0.026), RING)
    _cylinder(base, 0.0475, 0.006, (0, 0, 0.152), RING)
    base.mass, base.inertia, base.ipos = BASE_MASS_KG, [0.0046, 0.0045, 0.0021], [0, 0, 0.084]
    base.explicitinertial = True
    body = base
    for place, link in enumerate(LINKS):
        body = _add_link(body, link)
        ahead = LINKS[place + 1].origin_m if place + 1 < len(LINKS) else (0.0, 0.0, -TOOL_M)
        _clothe(body, link, ahead)
        _add_servo(spec, link)
    return body.add_body(name="flange", pos=[0, 0, -TOOL_M], quat=_roll(pi))


def _add_link(parent: mujoco.MjsBody, link: Link) -> mujoco.MjsBody:
    body = parent.add_body(name=link.name, pos=link.origin_m, quat=_roll(link.roll_rad))
    body.mass, body.ipos, body.fullinertia = link.mass_kg, link.centre_m, link.inertia_kgm2
    body.explicitinertial = True
    joint = body.add_joint(name=link.name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    # the inertia of rotor and gear as the link feels it: assumed
    joint.armature = 0.1
    if link.limit_rad is not None:
        joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, [-link.limit_rad, link.limit_rad]
    return body


def _add_servo(spec: mujoco.MjSpec, link: Link) -> None:
    large = link.torque_nm > 20
    servo = spec.add_actuator(name=link.name, target=link.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    # commanded by speed, so that set points move smoothly between commands: jumps would shake off what is held
    servo.set_to_intvelocity(kp=4000.0 if large else 1200.0, kv=240.0 if large else 40.0)
    servo.forcelimited, servo.forcerange = mujoco.mjtLimited.mjLIMITED_TRUE, [-link.torque_nm, link.torque_nm]


def _clothe(body: mujoco.MjsBody, link: Link, ahead: tuple[float, float, float]) -> None:
    """Shapes that look like the link: a tube to the next joint, and a ring or a cap at its own."""
    along = abs(ahead[2]) > abs(ahead[1])  # the tube runs along the axis of its own joint
    radius = link.radius_m
    _capsule(body, (0, 0, 0), ahead, radius, SHELL)
    if along:
        _cylinder(body, radius + 0.0015, 0.005, (0, 0, -0.004), RING)
    else:
        _cylinder(body, 0.82 * radius, radius + 0.004, (0, 0, 0), RING)
        _cylinder(body, 0.62 * radius, radius + 0.0055, (0, 0, 0), SHELL)
    if link is LINKS[-1]:
        # the vision module sits on top of the bracelet
        _box(body, (0.040, 0.014, 0.022), (0, 0.040, -0.030), BLACK)
        _cylinder(body, 0.036, 0.004, (0, 0, -TOOL_M + 0.004), RING)


def _roll(angle_rad: float) -> list[float]:
    return [float(np.cos(angle_rad / 2)), float(np.sin(angle_rad / 2)), 0.0, 0.0]


def _shape(body: mujoco.MjsBody, kind: mujoco.mjtGeom, material: str) -> mujoco.MjsGeom:
    geom = body.add_geom(type=kind, material=material)
    geom.contype = geom.conaffinity = 0
    geom.group, geom.mass = 1, 0.0
    return geom


def _capsule(
    body: mujoco.MjsBody,
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    radius: float,
    material: str,
) -> None:
    geom = _shape(body, mujoco.mjtGeom.mjGEOM_CAPSULE, material)
    geom.fromto = [*start, *end]
    geom.size = [radius, 0, 0]


def _cylinder(body: mujoco.MjsBody, radius: float, half: float, at: tuple[float, float, float], material: str) -> None:
    geom = _shape(body, mujoco.mjtGeom.mjGEOM_CYLINDER, material)
    geom.size, geom.pos = [radius, half, 0], at


def _box(
    body: mujoco.MjsBody,
    half: tuple[float, float, float],
    at: tuple[float, float, float],
    material: str,
) -> None:
    geom = _shape(body, mujoco.mjtGeom.mjGEOM_BOX, material)
    geom.size, geom.pos = half, at
