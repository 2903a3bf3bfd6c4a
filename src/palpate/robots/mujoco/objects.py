"""Objects of the bench: figures that physics needs, shape and look; what is true of them comes from a network."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.gripper import PAD_MM, STROKE_MM
from palpate.robots.mujoco.sound import Substance

__all__ = ["BenchObject", "Look", "Part"]


@dataclass(frozen=True)
class Look:
    """A surface.

    Attributes
    ----------
    pattern, light, dark
        A pattern of `palpate.robots.mujoco.textures` and its two colours, 0 to 255.
    opacity, gloss, repeat
        From 0 to 1; from 0 to 1; how often the pattern repeats along a side.
    """

    pattern: str = "plain"
    light: tuple[float, float, float] = (200.0, 200.0, 200.0)
    dark: tuple[float, float, float] = (150.0, 150.0, 150.0)
    opacity: float = 1.0
    gloss: float = 0.3
    repeat: float = 1.0


@dataclass(frozen=True)
class Part:
    """A shape with its surface; `figures` are those of its kind [mm], see `palpate.robots.mujoco.bodies`."""

    kind: str
    look: Look
    figures: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class BenchObject:
    """An object as the bench makes it: an outline with mass, and springs between two plates where it is gripped.

    Attributes
    ----------
    size_mm
        Outline: along the arm's reach, across it (the way the gripper closes), and up.
    grip_height_mm, grip_width_mm
        Where the pads meet it, above what it stands on, and its width there.
    contact_mm
        Width and height of what the pads can meet; the contact is no larger than a pad.
    wall_mm
        Thickness of what rings when it is knocked.
    knock_mm
        Where on top it is knocked at, from the middle.
    rack
        Whether it stands between two ledges, as it would fall over.
    """

    name: str
    mass_g: float
    elasticity_kpa: float
    substance: Substance
    size_mm: tuple[float, float, float]
    grip_height_mm: float
    grip_width_mm: float
    contact_mm: tuple[float, float] = PAD_MM
    wall_mm: float = 3.0
    knock_mm: tuple[float, float] = (0.0, 0.0)
    rack: bool = False
    parts: tuple[Part, ...] = ()

    def __post_init__(self) -> None:
        where = f"object {self.name!r}"
        for name in ("mass_g", "elasticity_kpa", "grip_width_mm", "grip_height_mm", "wall_mm"):
            if not getattr(self, name) > 0:
                raise BenchError(f"{where}: {name} {getattr(self, name)!r} was found, expected more than 0")
        if self.grip_width_mm > STROKE_MM - 2:
            raise BenchError(
                f"{where}: grip_width_mm {self.grip_width_mm:g} was found, expected at most {STROKE_MM - 2:g}: "
                f"the gripper opens to {STROKE_MM:g} mm"
            )

    @property
    def contact_area_mm2(self) -> float:
        """Area [mm2] over which the pads press."""
        return min(self.contact_mm[0], PAD_MM[0]) * min(self.contact_mm[1], PAD_MM[1])

    @property
    def stiffness_n_per_mm(self) -> float:
        """E A / L [N/mm] of what lies between the pads."""
        return self.elasticity_kpa * 1e-3 * self.contact_area_mm2 / self.grip_width_mm
