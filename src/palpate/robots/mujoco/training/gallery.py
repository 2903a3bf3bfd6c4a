"""Pictures of many things on the bench, one after the other: setting up a scene takes longer than drawing it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.bench import READY_M
from palpate.robots.mujoco.bodies import add_rack, add_shape
from palpate.robots.mujoco.camera import Camera
from palpate.robots.mujoco.furniture import IMAGE_SIZE, PLACE_M
from palpate.robots.mujoco.motion import reach
from palpate.robots.mujoco.objects import Look, Part
from palpate.robots.mujoco.scene import Scene
from palpate.robots.mujoco.training.outlines import CATEGORIES
from palpate.robots.mujoco.training.surfaces import MATERIALS, OWN, TRIMS, Hues

__all__ = ["Gallery", "Sight", "draw_sight"]

AWAY_M = (0.0, 0.0, -20.0)
"""Where things are that are not shown."""
OWN_SHARE = 0.7
"""How often a fruit has the surface of a fruit, of whatever material it is."""


@dataclass(frozen=True)
class Sight:
    """What a thing looks like, and what it is.

    Attributes
    ----------
    name
        Of its own: patterns are drawn by it.
    rack_mm
        Length and width of what a rack holds; None where it stands by itself.
    """

    name: str
    category: str
    material: str
    parts: tuple[Part, ...]
    height_mm: float
    rack_mm: tuple[float, float] | None = None


def draw_sight(name: str, category: str, material: str, hues: Hues, rng: np.random.Generator) -> Sight:
    """Draw a thing of a category and a material of the shipped networks, in colours of some hues.

    Examples
    --------
    >>> from palpate.robots.mujoco.training.surfaces import ALL
    >>> sight = draw_sight("first", "dice", "wood", ALL, np.random.default_rng(1))
    >>> [part.kind for part in sight.parts], sight.parts[0].look.pattern
    (['box'], 'wood')
    """
    outline = CATEGORIES[category](rng)
    own = outline.surfaces and rng.random() < OWN_SHARE
    look = (OWN[outline.surfaces[0]] if own else MATERIALS[material])(rng, hues)
    looks: dict[str, Look] = {**TRIMS, "whole": look}
    parts = tuple(Part(shape.kind, looks[shape.surface], shape.figures) for shape in outline.shapes)
    return Sight(name, category, material, parts, outline.height_mm, outline.rack_mm)


class Gallery:
    """Things of which one at a time is shown; to be closed, or used in a `with` statement.

    Parameters
    ----------
    sights
        A dozen or two: all of them are in the graphics' memory.
    """

    def __init__(self, sights: Sequence[Sight], size: tuple[int, int] = IMAGE_SIZE) -> None:
        self._sights = tuple(sights)
        self._scene = Scene(None, self._add)
        self._scene.home_rad = reach(self._scene, np.array(READY_M))
        self._scene.reset()
        self._camera = Camera(self._scene, size)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._camera.close()

    def image(
        self, number: int, *, off_mm: tuple[float, float] = (0.0, 0.0), turn_rad: float = 0.0, bright: float = 1.0
    ) -> NDArray[np.uint8]:
        """A picture of one of the things, (height, width, 3): off its place and turned, in other light.

        What stands in a rack stays where it is.
        """
        model, sight = self._scene.model, self._sights[number]
        body = model.body(_body(number)).id
        moves = sight.rack_mm is None
        aside = np.array(off_mm) / 1e3 if moves else np.zeros(2)
        model.body_pos[body] = [PLACE_M[0] + aside[0], PLACE_M[1] + aside[1], 0.0]
        half = turn_rad / 2 if moves else 0.0
        model.body_quat[body] = [np.cos(half), 0.0, 0.0, np.sin(half)]
        lamps = model.light_diffuse.copy()
        model.light_diffuse[:] = lamps * bright
        mujoco.mj_forward(model, self._scene.data)
        try:
            return self._camera.image()
        finally:
            model.body_pos[body] = AWAY_M
            model.light_diffuse[:] = lamps

    def _add(self, spec: mujoco.MjSpec) -> None:
        for number, sight in enumerate(self._sights):
            body = spec.worldbody.add_body(name=_body(number), pos=AWAY_M)
            add_shape(spec, body, sight.name, sight.parts, 0.0)
            if sight.rack_mm is not None:
                add_rack(body, sight.rack_mm, (0.0, 0.0))


def _body(number: int) -> str:
    return f"sight{number}"
