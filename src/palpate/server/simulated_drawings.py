"""Drawings of objects that nobody photographed: a shape for each category in the colour of a material.

Each shape is a signed distance to its surface, and the light is followed until it meets one (sphere tracing: Hart,
"Sphere tracing", The Visual Computer 12, 1996, with the distances of section 2 and of its appendix).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from palpate.network.model import KnownObject
from palpate.store.pictures import png

__all__ = ["DRAWING", "drawing", "kind_of"]

Array = NDArray[np.float64]
Shape = Callable[[Array], Array]
"""Points (n, 3) -> distances (n,), negative inside; it stands on y = 0, and lengths are in its own size."""

DRAWING = "simulated drawing.png"
ROWS, COLUMNS, FINER = 180, 240, 2
"""Each pixel is the mean of so many in both directions."""
STEPS, NEAR = 48, 2e-3
CAMERA, LOOKS_AT = np.array([0.0, 2.1, 4.6]), np.array([0.0, 0.62, 0.0])
VIEW = 0.27
"""Half of the height that is seen, at distance 1."""
LIGHT = np.array([-0.55, 0.75, 0.36])
TURNED = 0.56
"""Angle of what has corners, so that two sides are seen."""
BACKGROUND = np.array([236.0, 233.0, 224.0])
COLOURS = {
    "ceramic": (226, 219, 205),
    "foam": (228, 196, 84),
    "glass": (168, 200, 206),
    "hard-plastic": (180, 72, 60),
    "metal": (150, 156, 164),
    "paper": (204, 180, 140),
    "soft-plastic": (236, 150, 70),
    "wood": (160, 112, 64),
}


def kind_of(thing: KnownObject) -> tuple[str, str]:
    """Category and material of an object, by which it is drawn; empty where they are not told."""
    category, material = (thing.truth.get(name) for name in ("category", "material"))
    return str(category.value) if category else "", str(material.value) if material else ""


def drawing(category: str, material: str) -> bytes:
    """A thing of a category and a material on a table, as PNG; of a category without a shape, a ball."""
    lit, shine, covered, ground = _scene(category if category in SHAPES else "fruit")
    thing = (
        np.array(COLOURS.get(material, (150, 150, 150)), float) * lit[..., np.newaxis] + 70.0 * shine[..., np.newaxis]
    )
    fine = np.where(covered[..., np.newaxis], thing, BACKGROUND * ground[..., np.newaxis])
    coarse = fine.reshape(ROWS, FINER, COLUMNS, FINER, 3).mean(axis=(1, 3))
    return png(np.clip(coarse, 0, 255).astype(np.uint8), DRAWING)


@lru_cache(maxsize=16)
def _scene(category: str) -> tuple[Array, Array, NDArray[np.bool_], Array]:
    """How bright the thing is, how it shines, where it is, and how bright the table is, each (rows, columns)."""
    shape, rays = SHAPES[category], _rays()
    points, covered = _met(shape, rays)
    normals = _normals(shape, points)
    light = LIGHT / np.linalg.norm(LIGHT)
    lit = 0.38 + 0.62 * np.maximum(0.0, normals @ light)
    halfway = light - rays
    halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
    shine = np.maximum(0.0, np.einsum("ij,ij->i", normals, halfway)) ** 40
    size = (ROWS * FINER, COLUMNS * FINER)
    ground = np.where(rays[:, 1] < 0, _table(rays), 1.0)
    return lit.reshape(size), shine.reshape(size), covered.reshape(size), ground.reshape(size)


def _rays() -> Array:
    """Directions of unit length, (rows x columns, 3)."""
    forward = (LOOKS_AT - CAMERA) / np.linalg.norm(LOOKS_AT - CAMERA)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    rows, columns = np.mgrid[0 : ROWS * FINER, 0 : COLUMNS * FINER] + 0.5
    across, up = columns / FINER - COLUMNS / 2, ROWS / 2 - rows / FINER
    found = forward + VIEW / (ROWS / 2) * (across.reshape(-1, 1) * right + up.reshape(-1, 1) * np.cross(right, forward))
    unit: Array = found / np.linalg.norm(found, axis=1, keepdims=True)
    return unit


def _met(shape: Shape, rays: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Where rays end, (n, 3), and which of them at the shape."""
    far, left = np.zeros(len(rays)), np.arange(len(rays))
    covered = np.zeros(len(rays), bool)
    for _ in range(STEPS):
        distance = shape(CAMERA + far[left, np.newaxis] * rays[left])
        far[left] += distance
        covered[left[distance < NEAR]] = True
        left = left[(distance >= NEAR) & (far[left] < 9.0)]
    return CAMERA + far[:, np.newaxis] * rays, covered


def _normals(shape: Shape, points: Array) -> Array:
    around = [shape(points + step) - shape(points - step) for step in 1e-3 * np.eye(3)]
    slopes = np.stack(around, axis=1)
    unit: Array = slopes / np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-12)
    return unit


def _table(rays: Array) -> Array:
    """How bright the table is where a ray meets it: darker under the thing and to the right of it."""
    across, _, along = (CAMERA - CAMERA[1] * rays / np.minimum(rays[:, 1:2], -1e-9)).T
    shadow: Array = np.exp(-(((across - 0.22) / 0.95) ** 2) - ((along + 0.1) / 0.6) ** 2)
    return 1 - 0.42 * shadow


def _ball(p: Array, height: float, radius: float) -> Array:
    distance: Array = np.linalg.norm(p - [0.0, height, 0.0], axis=1) - radius
    return distance


def _block(p: Array, half: tuple[float, float, float], edge: float = 0.06) -> Array:
    """A block with rounded edges, turned a little."""
    along, aside = np.cos(TURNED), np.sin(TURNED)
    (x, y, z) = p.T
    turned = np.stack([along * x + aside * z, y - half[1], along * z - aside * x], axis=1)
    over = np.abs(turned) - np.array(half) + edge
    distance: Array = np.linalg.norm(np.maximum(over, 0), axis=1) + np.minimum(over.max(axis=1), 0) - edge
    return distance


def _can(p: Array, low: float, high: float, radius: float, edge: float = 0.02) -> Array:
    """An upright cylinder with rounded edges."""
    out = np.hypot(p[:, 0], p[:, 2]) - radius + edge
    up = np.abs(p[:, 1] - (low + high) / 2) - (high - low) / 2 + edge
    distance: Array = np.hypot(np.maximum(out, 0), np.maximum(up, 0)) + np.minimum(np.maximum(out, up), 0) - edge
    return distance


def _fruit(p: Array) -> Array:
    """A ball with a dent and a stalk."""
    flat = p / [1.0, 0.92, 1.0]
    dented = np.maximum(_ball(flat, 0.76, 0.76), -_ball(flat, 1.72, 0.3))
    return np.minimum(dented * 0.9, _can(p, 1.2, 1.62, 0.045))


def _mug(p: Array) -> Array:
    outside = _can(p, 0.0, 1.3, 0.62, 0.05)
    ring = np.hypot(np.hypot(p[:, 0] - 0.66, p[:, 1] - 0.66) - 0.32, p[:, 2]) - 0.075
    return np.maximum(np.minimum(outside, ring), -_can(p, 0.08, 2.0, 0.54))


def _bowl(p: Array) -> Array:
    shell = np.abs(_ball(p, 0.9, 0.86)) - 0.04
    return np.minimum(np.maximum(shell, p[:, 1] - 0.85), _can(p, 0.0, 0.1, 0.35))


def _wineglass(p: Array) -> Array:
    egg = p / [1.0, 1.25, 1.0]
    cup = np.maximum(np.abs(_ball(egg, 1.0, 0.46)) - 0.025, p[:, 1] - 1.6)
    return np.minimum(np.minimum(cup * 0.8, _can(p, 0.0, 0.72, 0.05)), _can(p, 0.0, 0.05, 0.44))


def _bottle(p: Array) -> Array:
    shoulder = _ball(p, 0.92, 0.36)
    return np.minimum(np.minimum(_can(p, 0.0, 0.95, 0.36, 0.05), shoulder), _can(p, 0.9, 1.6, 0.13))


SHAPES: dict[str, Shape] = {
    "bottle": _bottle,
    "bowl": _bowl,
    "box": lambda p: _block(p, (0.85, 0.52, 0.5)),
    "can": lambda p: _can(p, 0.0, 1.2, 0.5, 0.04),
    "dice": lambda p: _block(p, (0.62, 0.62, 0.62), 0.1),
    "fruit": _fruit,
    "mug": _mug,
    "plate": lambda p: _can(p, 0.0, 0.14, 1.15, 0.06),
    "sodacan": lambda p: _can(p, 0.0, 1.35, 0.42, 0.08),
    "wineglass": _wineglass,
}
