"""Outlines of things of each category, drawn at random: parts without a surface, in mm.

They are of the kinds of `palpate.robots.mujoco.bodies`. All proportions are assumed. A category holds what its name
says and what the shipped networks use it for: sponges and bricks are boxes, upright tiles plates, cubes dice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

__all__ = ["CATEGORIES", "Outline", "Shape"]

Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Shape:
    """A part: its kind and figures, and whether it has the surface of the whole or one of its own, like a leaf."""

    kind: str
    figures: Mapping[str, Any]
    surface: str = "whole"


@dataclass(frozen=True)
class Outline:
    """Shapes that stand on the table, how high they are [mm], and how wide a rack must be that holds them, if any."""

    shapes: tuple[Shape, ...]
    height_mm: float
    rack_mm: tuple[float, float] | None = None
    surfaces: tuple[str, ...] = field(default=())
    """Surfaces that only this kind of thing has, one of which it may take in place of its material's."""


def _hollow(outside: Points, wall: float) -> Shape:
    """A lathe's profile, up the outside and back down the inside."""
    inside = [(max(r - wall, 1.0), max(z, outside[0][1] + wall)) for r, z in reversed(outside[1:])]
    return Shape("lathe", {"profile_mm": [(0.0, outside[0][1]), *outside, *inside, (0.0, inside[-1][1])]})


def _box(x: float, y: float, z: float, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Shape:
    return Shape("box", {"size_mm": (x, y, z), "at_mm": at})


def bottle(rng: np.random.Generator) -> Outline:
    radius, height = rng.uniform(22, 40), rng.uniform(130, 215)
    shoulder, neck = rng.uniform(0.5, 0.75) * height, rng.uniform(0.28, 0.5) * radius
    profile = [(radius * 0.94, 0), (radius, 6), (radius, shoulder), (neck, shoulder + 0.8 * radius), (neck, height)]
    cap = Shape("cylinder", {"radius_mm": neck * 1.2, "height_mm": 12.0, "at_mm": (0, 0, height - 6)}, "trim")
    shapes = [Shape("lathe", {"profile_mm": [(0, 0), *profile, (0, height)]})]
    return Outline((*shapes, cap) if rng.random() < 0.6 else tuple(shapes), height + 6)


def bowl(rng: np.random.Generator) -> Outline:
    radius, share = rng.uniform(45, 80), rng.uniform(0.35, 0.7)
    height, foot = share * radius, rng.uniform(0.35, 0.6) * radius
    steps = np.linspace(0, np.pi / 2, 6)
    curve = [(foot + (radius - foot) * np.sin(a), height * (1 - np.cos(a))) for a in steps]
    return Outline((_hollow([(float(r), float(z)) for r, z in curve], rng.uniform(2, 5)),), height)


def box(rng: np.random.Generator) -> Outline:
    kind = rng.random()
    if kind < 0.4:
        size = (rng.uniform(70, 160), rng.uniform(35, 80), rng.uniform(110, 215))
    elif kind < 0.7:
        size = (rng.uniform(65, 130), rng.uniform(40, 80), rng.uniform(22, 55))
    else:
        size = (rng.uniform(100, 170), rng.uniform(55, 83), rng.uniform(50, 90))
        x, y, z = size
        lid = _box(x, y, 0.24 * z, (0, 0, 0.76 * z))
        clasp = Shape("box", {"size_mm": (4.0, 18.0, 14.0), "at_mm": (x / 2, 0, 0.64 * z)}, "metal")
        return Outline((_box(x, y, 0.75 * z), lid, clasp) if rng.random() < 0.6 else (_box(*size),), z)
    return Outline((_box(*size),), size[2])


def can(rng: np.random.Generator) -> Outline:
    radius, height = rng.uniform(33, 50), rng.uniform(55, 115)
    body = Shape("cylinder", {"radius_mm": radius, "height_mm": height})
    rims = [
        Shape("cylinder", {"radius_mm": radius * 1.03, "height_mm": 3.0, "at_mm": (0, 0, z)}, "metal")
        for z in (0.0, height - 2.5)
    ]
    return Outline((body, *rims), height)


def dice(rng: np.random.Generator) -> Outline:
    side = rng.uniform(28, 68)
    return Outline((_box(side, side, side),), side)


def fruit(rng: np.random.Generator) -> Outline:
    return (_banana, _berry, _round)[int(rng.integers(3))](rng)


def _banana(rng: np.random.Generator) -> Outline:
    half, thick, bend = rng.uniform(65, 100), rng.uniform(13, 21), rng.uniform(18, 50)
    along = np.linspace(-1, 1, 7)
    path = [(half * a, 0.0, thick + bend * a * a) for a in along]
    radii = [thick * share for share in (0.3, 0.78, 0.97, 1.0, 0.95, 0.72, 0.25)]
    end = (half, 0.0, thick + bend)
    stem = Shape(
        "tube",
        {"path_mm": [end, (half + 5, 0, end[2] + 6), (half + 8, 0, end[2] + 13)], "radii_mm": [4, 3.5, 4]},
        "stem",
    )
    return Outline((Shape("tube", {"path_mm": path, "radii_mm": radii}), stem), thick + bend + 14, surfaces=("peel",))


def _berry(rng: np.random.Generator) -> Outline:
    radius, height = rng.uniform(16, 26), rng.uniform(36, 58)
    profile = [(0, 0), (0.26, 0.03), (0.55, 0.14), (0.85, 0.4), (1, 0.65), (0.98, 0.8), (0.8, 0.93), (0.4, 1), (0, 1)]
    leaf = [(0, 1.0), (0.48, 1.02), (0.9, 0.93), (0.95, 0.96), (0.45, 1.07), (0, 1.08)]
    body, top = ([(r * radius, z * height) for r, z in points] for points in (profile, leaf))
    shapes = (Shape("lathe", {"profile_mm": body}), Shape("lathe", {"profile_mm": top}, "leaf"))
    return Outline(shapes, 1.08 * height, surfaces=("berry",))


def _round(rng: np.random.Generator) -> Outline:
    wide, high = rng.uniform(55, 83), rng.uniform(0.8, 1.15)
    body = Shape("ellipsoid", {"size_mm": (wide, wide, wide * high)})
    stem = Shape("cylinder", {"radius_mm": 2.0, "height_mm": 12.0, "at_mm": (0, 0, wide * high - 4)}, "stem")
    return Outline((body, stem), wide * high + 8, surfaces=("skin",))


def mug(rng: np.random.Generator) -> Outline:
    low, high, height = rng.uniform(28, 42), rng.uniform(34, 43), rng.uniform(62, 105)
    body = _hollow([(0.9 * low, 0), (low, 5), (high, height - 3), (high, height)], rng.uniform(1.5, 5))
    if rng.random() < 0.3:
        return Outline((body,), height)
    reach, thick, foot = rng.uniform(20, 34), rng.uniform(4, 7), rng.uniform(0.2, 0.35) * height
    path = [(low - 2, 0, foot), (low + 0.8 * reach, 0, foot + 6), (low + reach, 0, 0.55 * height)]
    path += [(high + 0.7 * reach, 0, 0.82 * height), (high - 3, 0, 0.8 * height)]
    return Outline((body, Shape("tube", {"path_mm": path, "radii_mm": [thick] * 5})), height)


def plate(rng: np.random.Generator) -> Outline:
    if rng.random() < 0.5:
        length, thick, height = rng.uniform(90, 170), rng.uniform(5, 12), rng.uniform(80, 140)
        return Outline((_box(length, thick, height),), height, rack_mm=(length, thick))
    radius, height = rng.uniform(65, 95), rng.uniform(12, 24)
    profile = [(0.55 * radius, 0.0), (0.65 * radius, 0.15 * height), (radius, height)]
    return Outline((_hollow(profile, 3.0),), height)


def sodacan(rng: np.random.Generator) -> Outline:
    radius, height = rng.uniform(26, 34), rng.uniform(112, 168)
    body = [(0, 0), (0.75 * radius, 0), (radius, 9), (radius, height - 12), (0.82 * radius, height - 2)]
    lid = Shape("cylinder", {"radius_mm": 0.84 * radius, "height_mm": 3.0, "at_mm": (0, 0, height - 3)}, "metal")
    return Outline((Shape("lathe", {"profile_mm": [*body, (0, height - 2)]}), lid), height)


def wineglass(rng: np.random.Generator) -> Outline:
    foot, stem, height = rng.uniform(30, 40), rng.uniform(50, 95), rng.uniform(150, 225)
    wide, top = rng.uniform(30, 42), rng.uniform(0.7, 0.95)
    bowl_mm = height - stem
    outside = [(0, 0), (foot, 0), (foot, 2.5), (0.3 * foot, 7), (4.5, 14), (4, stem - 12), (9, stem)]
    outside += [(0.85 * wide, stem + 0.2 * bowl_mm), (wide, stem + 0.45 * bowl_mm), (top * wide, height)]
    inside = [
        (top * wide - 1.4, height),
        (wide - 1.6, stem + 0.45 * bowl_mm),
        (0.85 * wide - 1.6, stem + 0.22 * bowl_mm),
    ]
    return Outline((Shape("lathe", {"profile_mm": [*outside, *inside, (0, stem + 3)]}),), height)


CATEGORIES: Mapping[str, Callable[[np.random.Generator], Outline]] = {
    "bottle": bottle,
    "bowl": bowl,
    "box": box,
    "can": can,
    "dice": dice,
    "fruit": fruit,
    "mug": mug,
    "plate": plate,
    "sodacan": sodacan,
    "wineglass": wineglass,
}
"""What draws an outline of each category of the shipped networks."""
