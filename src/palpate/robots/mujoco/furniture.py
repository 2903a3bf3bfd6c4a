"""What stands around the arm: floor, wall, table, lamps and cameras; and the materials of all of it."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.textures import Pixels, add_texture, grain

__all__ = ["CAMERA", "IMAGE_SIZE", "OVERVIEW", "PLACE_M", "TABLE_BIT", "add_furniture"]

CAMERA, OVERVIEW = "camera", "overview"
IMAGE_SIZE = (640, 480)
"""Width and height of the camera's image [pixels]."""
PLACE_M = (0.46, 0.0)
"""Where on the table the object stands, from the arm's base."""
TABLE_BIT = 1
FLOOR_M = -0.74


def add_furniture(spec: mujoco.MjSpec) -> None:
    """Add everything but arm, gripper and object to an empty specification."""
    _set_light(spec)
    _add_materials(spec)
    world = spec.worldbody
    floor = world.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[7, 7, 0.1], pos=[0, 0, FLOOR_M], material="floor")
    wall = world.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.02, 7, 2.6], pos=[-1.1, 0, 1.8], material="wall")
    for geom in (floor, wall):
        geom.contype = geom.conaffinity = 0
    _add_table(world)
    # the camera looks at the object from the side away from the arm
    _add_camera(world, CAMERA, eye=(1.16, -0.36, 0.42), at=(PLACE_M[0], 0.0, 0.085), fovy_deg=23)
    _add_camera(world, OVERVIEW, eye=(1.45, -1.25, 0.78), at=(0.22, 0.02, 0.22), fovy_deg=36)


def _set_light(spec: mujoco.MjSpec) -> None:
    width, height = IMAGE_SIZE
    view = spec.visual
    view.global_.offwidth, view.global_.offheight = 2 * width, 2 * height
    view.quality.shadowsize, view.quality.offsamples = 2048, 4
    view.map.znear, view.map.zfar = 0.02, 12.0
    view.headlight.ambient, view.headlight.diffuse, view.headlight.specular = [0.34] * 3, [0.26] * 3, [0.0] * 3
    spec.stat.extent, spec.stat.center = 1.0, [0.3, 0, 0.2]
    lamp = spec.worldbody.add_light(name="lamp", pos=[1.1, -0.9, 1.9], dir=[-0.42, 0.45, -0.95])
    lamp.type, lamp.castshadow = mujoco.mjtLightType.mjLIGHT_SPOT, True
    lamp.cutoff, lamp.exponent = 60.0, 2.0
    lamp.diffuse, lamp.specular = [0.62, 0.60, 0.56], [0.35] * 3
    fill = spec.worldbody.add_light(name="fill", pos=[0.2, 1.8, 1.5], dir=[0.0, -0.8, -0.6])
    fill.type, fill.castshadow = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, False
    fill.diffuse, fill.specular = [0.18, 0.20, 0.24], [0.1] * 3


def _add_materials(spec: mujoco.MjSpec) -> None:
    add_texture(spec, "wood_top", _planks(), flat=True)
    top = spec.add_material(name="table", rgba=[1, 1, 1, 1], specular=0.25, shininess=0.3)
    top.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "wood_top"
    plain = {
        "floor": ([0.42, 0.43, 0.45, 1], 0.1, 0.1),
        "wall": ([0.80, 0.82, 0.83, 1], 0.0, 0.0),
        "steel": ([0.36, 0.37, 0.39, 1], 0.5, 0.5),
        "shell": ([0.88, 0.89, 0.90, 1], 0.5, 0.6),
        "ring": ([0.17, 0.18, 0.20, 1], 0.4, 0.5),
        "black": ([0.07, 0.07, 0.08, 1], 0.5, 0.6),
        "rubber": ([0.12, 0.12, 0.13, 1], 0.05, 0.1),
    }
    for name, (rgba, specular, shininess) in plain.items():
        spec.add_material(name=name, rgba=rgba, specular=specular, shininess=shininess)


def _planks() -> Pixels:
    """A table top of beech: long streaks, and joints between the planks."""
    rng = np.random.default_rng(11)
    image = grain(rng, (512, 512), light=(214, 180, 136), dark=(178, 139, 95), streak=40).astype(float)
    for edge in range(0, 512, 128):
        image[edge : edge + 128] *= rng.uniform(0.94, 1.05)
        image[edge : edge + 2] *= 0.82
    return np.asarray(np.clip(image, 0, 255), dtype=np.uint8)


def _add_table(world: mujoco.MjsBody) -> None:
    top = world.add_geom(name="table", type=mujoco.mjtGeom.mjGEOM_BOX, material="table")
    top.size, top.pos = [0.52, 0.62, 0.018], [0.30, 0, -0.018]
    top.contype, top.conaffinity = TABLE_BIT, TABLE_BIT
    top.friction = [0.6, 0.005, 0.0001]
    for x in (-0.16, 0.76):
        for y in (-0.56, 0.56):
            leg = world.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, material="steel")
            leg.size, leg.pos = [0.025, 0.025, 0.35], [x, y, FLOOR_M + 0.35]
            leg.contype = leg.conaffinity = 0


def _add_camera(
    world: mujoco.MjsBody,
    name: str,
    eye: tuple[float, float, float],
    at: tuple[float, float, float],
    fovy_deg: float,
) -> None:
    back: NDArray[np.float64] = np.subtract(eye, at) / np.linalg.norm(np.subtract(eye, at))
    right = np.cross([0, 0, 1], back)
    right /= np.linalg.norm(right)
    # a camera looks along its -z
    turn, quat = np.stack([right, np.cross(back, right), back], axis=1), np.zeros(4)
    mujoco.mju_mat2Quat(quat, turn.ravel())
    world.add_camera(name=name, pos=eye, quat=quat, fovy=fovy_deg)
