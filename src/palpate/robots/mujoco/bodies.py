"""An object's body in physics.

Contacts of a rigid-body engine have no stiffness of their own, so the object has one: a core that carries mass, shape
and look, and a plate on either side where the gripper's pads meet it, each on a spring of 2 k. The two in a row give
way like one elastic block between two plates, k = E A / L.

Kinds of parts and their figures [mm], each with `at_mm` (default 0, 0, 0; the middle of the outline's bottom):

- box: `size_mm`; ellipsoid: `size_mm`; cylinder: `radius_mm`, `height_mm`;
- lathe: `profile_mm`, points (radius, height) of the outside from the bottom up, and back down the inside of a hollow;
- tube: `path_mm`, points, and `radii_mm` at them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any
from zlib import crc32

import mujoco
import numpy as np

from palpate.errors import choices
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.furniture import PLACE_M, TABLE_BIT
from palpate.robots.mujoco.gripper import PAD_BIT, PAD_FRICTION, PAD_SOLIMP, PAD_SOLREF
from palpate.robots.mujoco.objects import BenchObject, Look, Part
from palpate.robots.mujoco.shapes import Mesh, lathe, tube
from palpate.robots.mujoco.textures import PATTERNS, add_texture

__all__ = ["RACK_MM", "add_object", "add_rack", "add_shape"]

CORE_BIT = 2
PLATE_KG = 2e-4
# As a plate feels it along its spring only: keeps the springs slow enough for the time step, and weighs nothing.
PLATE_INERTIA_KG, FASTEST_RAD_S = 0.05, 350.0
PLATE_DAMPING = 0.3
MOST_STRAIN = 0.8
"""Beyond it, foam is as good as solid."""
RACK_MM, RACK_HALF_M = 18.0, 0.006
RACK_ROOM_M = 0.003
"""Room to either side, so that a gripper that is not quite in the middle does not press against a ledge."""


def add_object(spec: mujoco.MjSpec, thing: BenchObject) -> None:
    """Add the object, standing at its place on the table: bodies `object`, `near` and `far`, with joints so named."""
    length, width, height = (size / 1e3 for size in thing.size_mm)
    core = spec.worldbody.add_body(name="object", pos=[*PLACE_M, height / 2])
    core.add_freejoint(name="object")
    outline = core.add_geom(name="outline", type=mujoco.mjtGeom.mjGEOM_BOX, size=[length / 2, width / 2, height / 2])
    outline.mass = thing.mass_g / 1e3 - 2 * PLATE_KG
    outline.contype, outline.conaffinity, outline.group = CORE_BIT, TABLE_BIT, 4
    outline.friction = [0.5, 0.005, 0.0001]
    outline.solref, outline.solimp = [0.006, 1.0], [0.95, 0.99, 0.001, 0.5, 2]
    for name, side in (("near", -1.0), ("far", 1.0)):
        _add_plate(core, thing, name, side)
    add_shape(spec, core, thing.name, thing.parts, -height / 2)
    if thing.rack:
        add_rack(spec.worldbody, thing.size_mm[:2], PLACE_M)


def add_shape(spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, parts: Sequence[Part], bottom_m: float) -> None:
    """Add what is seen of a thing to a body, whose middle is so far above the thing's bottom, with a minus."""
    for place, part in enumerate(parts):
        _add_part(spec, body, f"{name}_{place}", part, bottom_m)


def _add_plate(core: mujoco.MjsBody, thing: BenchObject, name: str, side: float) -> None:
    half_width, depth = thing.grip_width_mm / 2e3, (thing.grip_height_mm - thing.size_mm[2] / 2) / 1e3
    half_thick = min(0.002, half_width / 3)
    plate = core.add_body(name=name, pos=[0, side * (half_width - half_thick), depth])
    joint = plate.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, -side, 0])
    stiffness = 2 * thing.stiffness_n_per_mm * 1e3  # [N/m]
    joint.stiffness = [stiffness, 0, 0]
    inertia = max(PLATE_INERTIA_KG, stiffness / FASTEST_RAD_S**2)
    joint.armature, joint.damping = inertia, [2 * PLATE_DAMPING * (stiffness * inertia) ** 0.5, 0, 0]
    joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, [-1e-3, MOST_STRAIN * half_width]
    face = plate.add_geom(name=f"{name}_plate", type=mujoco.mjtGeom.mjGEOM_BOX)
    face.size = [thing.contact_mm[0] / 2e3, half_thick, thing.contact_mm[1] / 2e3]
    face.mass, face.group = PLATE_KG, 4
    face.contype, face.conaffinity = 0, PAD_BIT
    face.condim, face.friction = 4, PAD_FRICTION
    face.solref, face.solimp = PAD_SOLREF, PAD_SOLIMP


def _add_part(spec: mujoco.MjSpec, core: mujoco.MjsBody, name: str, part: Part, bottom_m: float) -> None:
    if part.kind not in _KINDS:
        raise BenchError(f"part {name!r}: kind {part.kind!r} was found: {choices(_KINDS)}")
    geom = core.add_geom(material=_add_look(spec, name, part.look))
    geom.contype = geom.conaffinity = 0
    geom.mass, geom.group = 0.0, 1
    figures = {"at_mm": (0.0, 0.0, 0.0), **part.figures}
    geom.pos = np.asarray(figures["at_mm"], dtype=float) / 1e3 + [0, 0, bottom_m]
    try:
        _KINDS[part.kind](spec, geom, name, figures)
    except KeyError as missing:
        raise BenchError(f"part {name!r} of kind {part.kind!r} lacks {missing.args[0]!r}") from None


Figures = Mapping[str, Any]


def _box(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, name: str, figures: Figures) -> None:
    _solid(geom, mujoco.mjtGeom.mjGEOM_BOX, figures["size_mm"])


def _ellipsoid(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, name: str, figures: Figures) -> None:
    _solid(geom, mujoco.mjtGeom.mjGEOM_ELLIPSOID, figures["size_mm"])


def _cylinder(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, name: str, figures: Figures) -> None:
    radius, height = figures["radius_mm"], figures["height_mm"]
    _solid(geom, mujoco.mjtGeom.mjGEOM_CYLINDER, (2 * radius, height, 0))
    geom.pos[2] += height / 2e3


def _solid(geom: mujoco.MjsGeom, kind: mujoco.mjtGeom, size_mm: Sequence[float]) -> None:
    """Make it of this size; boxes and ellipsoids stand on their lowest point."""
    geom.type, geom.size = kind, [size / 2e3 for size in size_mm]
    geom.pos[2] += size_mm[2] / 2e3


def _lathe(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, name: str, figures: Figures) -> None:
    _mesh(spec, geom, name, lathe(figures["profile_mm"]))


def _tube(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, name: str, figures: Figures) -> None:
    _mesh(spec, geom, name, tube(figures["path_mm"], figures["radii_mm"]))


def _mesh(spec: mujoco.MjSpec, geom: mujoco.MjsGeom, name: str, made: Mesh) -> None:
    corners, faces = made
    mesh = spec.add_mesh(name=name)
    mesh.uservert, mesh.userface = (corners / 1e3).ravel().tolist(), faces.ravel().tolist()
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    geom.type, geom.meshname = mujoco.mjtGeom.mjGEOM_MESH, name


_KINDS: Mapping[str, Callable[[mujoco.MjSpec, mujoco.MjsGeom, str, Figures], None]] = {
    "box": _box,
    "ellipsoid": _ellipsoid,
    "cylinder": _cylinder,
    "lathe": _lathe,
    "tube": _tube,
}


def _add_look(spec: mujoco.MjSpec, name: str, look: Look) -> str:
    if look.pattern not in PATTERNS:
        raise BenchError(f"part {name!r}: pattern {look.pattern!r} was found: {choices(PATTERNS)}")
    rng = np.random.default_rng(crc32(name.encode()))
    add_texture(spec, name, PATTERNS[look.pattern](rng, look.light, look.dark))
    material = spec.add_material(name=name, rgba=[1, 1, 1, look.opacity], specular=look.gloss, shininess=look.gloss)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    material.texrepeat = [look.repeat, look.repeat]
    return name


def add_rack(body: mujoco.MjsBody, size_mm: tuple[float, float], at_m: tuple[float, float]) -> None:
    """Add two ledges beside what would fall over, of that length and width, with a little room."""
    length, width = (size / 1e3 for size in size_mm)
    height = RACK_MM / 1e3
    for side in (-1.0, 1.0):
        ledge = body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, material="steel")
        ledge.size = [0.42 * length, RACK_HALF_M, height / 2]
        ledge.pos = [at_m[0], at_m[1] + side * (width / 2 + RACK_ROOM_M + RACK_HALF_M), height / 2]
        ledge.contype, ledge.conaffinity = TABLE_BIT, TABLE_BIT
