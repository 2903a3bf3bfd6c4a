"""Looking: an image of the object by the camera."""

from __future__ import annotations

import mujoco
import numpy as np

from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.furniture import CAMERA
from palpate.robots.signals import ImageSignals

__all__ = ["look"]


def look(bench: Bench) -> ImageSignals:
    """Put the object down a little differently each time, and see it."""
    bench.reset()
    scene, noise, rng = bench.scene, bench.noise, bench.rng
    spot = scene.data.joint("object").qpos
    if not bench.thing.rack:
        spot[:2] += noise.place_sd_mm / 1e3 * rng.standard_normal(2)
        half = np.radians(noise.turn_sd_deg) * rng.standard_normal() / 2
        spot[3:7] = [np.cos(half), 0.0, 0.0, np.sin(half)]
    bright = np.exp(noise.light_sd * rng.standard_normal())
    lamps = scene.model.light_diffuse.copy()
    scene.model.light_diffuse[:] = lamps * bright
    mujoco.mj_forward(scene.model, scene.data)
    try:
        image = bench.camera.image(CAMERA)
    finally:
        scene.model.light_diffuse[:] = lamps
    if noise.pixel_sd > 0:
        grain = noise.pixel_sd * rng.standard_normal(image.shape, dtype=np.float32)
        image = np.clip(image + grain, 0, 255).astype(np.uint8)
    return ImageSignals(image)
