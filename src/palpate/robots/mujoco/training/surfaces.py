"""Surfaces of each material, drawn at random: patterns are those of the bench, colours are assumed.

Many materials may look alike: a plain glossy red is of ceramic, enamelled metal or plastic. Nothing here makes them
differ where real ones do not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import hsv_to_rgb

from palpate.robots.mujoco.objects import Look

__all__ = ["ALL", "MATERIALS", "OWN", "SEEN", "TRIMS", "UNSEEN", "Hues"]

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Hues:
    """Arcs of the colour circle, each from one share of it to another."""

    arcs: tuple[tuple[float, float], ...]

    def draw(self, rng: np.random.Generator) -> float:
        """One hue, each as likely as any other."""
        widths = np.array([high - low for low, high in self.arcs])
        low, high = self.arcs[int(rng.choice(len(self.arcs), p=widths / widths.sum()))]
        return float(rng.uniform(low, high))


ALL = Hues(((0.0, 1.0),))
UNSEEN = Hues(((0.50, 0.72),))
"""Blues: no coloured thing of the training set has one of them."""
SEEN = Hues(((0.0, 0.50), (0.72, 1.0)))


def _colour(hue: float, saturation: float, value: float) -> Colour:
    red, green, blue = hsv_to_rgb((hue, min(saturation, 1.0), min(value, 1.0))) * 255
    return float(red), float(green), float(blue)


def _shaded(
    pattern: str,
    colour: tuple[float, float, float],
    darker: float,
    rng: np.random.Generator,
    gloss: float,
    opacity: float = 1.0,
) -> Look:
    """A pattern in a colour (hue, saturation, value) and a darker one."""
    hue, saturation, value = colour
    dark = _colour(hue, saturation, value * darker * rng.uniform(0.9, 1))
    return Look(pattern, _colour(*colour), dark, opacity, gloss)


def _strong(rng: np.random.Generator, hues: Hues) -> tuple[float, float, float]:
    return hues.draw(rng), rng.uniform(0.45, 1), rng.uniform(0.45, 0.95)


def ceramic(rng: np.random.Generator, hues: Hues) -> Look:
    if rng.random() < 0.6:
        colour, darker = (0.1, rng.uniform(0, 0.12), rng.uniform(0.85, 0.98)), 0.93
    else:
        colour, darker = (hues.draw(rng), rng.uniform(0.15, 0.7), rng.uniform(0.4, 0.9)), 0.85
    return _shaded("plain", colour, darker, rng, rng.uniform(0.75, 1.0))


def glass(rng: np.random.Generator, hues: Hues) -> Look:
    tinted = rng.random() < 0.4
    hue, saturation = (hues.draw(rng), rng.uniform(0.1, 0.6)) if tinted else (0.55, rng.uniform(0.03, 0.12))
    return _shaded("plain", (hue, saturation, rng.uniform(0.85, 0.97)), 0.95, rng, 1.0, rng.uniform(0.25, 0.5))


def metal(rng: np.random.Generator, hues: Hues) -> Look:
    kind, gloss = rng.random(), rng.uniform(0.8, 1.0)
    if kind < 0.3:
        ground = _colour(hues.draw(rng), rng.uniform(0.4, 0.9), rng.uniform(0.4, 0.85))
        return Look("speckles", light=ground, dark=(250, 246, 240), gloss=gloss)
    hue, saturation = (0.12, rng.uniform(0.4, 0.7)) if kind < 0.5 else (0.6, rng.uniform(0, 0.06))
    return _shaded("plain", (hue, saturation, rng.uniform(0.45, 0.8)), 0.75, rng, gloss)


def soft_plastic(rng: np.random.Generator, hues: Hues) -> Look:
    return _shaded("plain", _strong(rng, hues), 0.88, rng, rng.uniform(0.15, 0.5))


def hard_plastic(rng: np.random.Generator, hues: Hues) -> Look:
    if rng.random() < 0.2:
        return _shaded("plain", (0.55, rng.uniform(0.02, 0.1), 0.9), 0.95, rng, 0.9, rng.uniform(0.3, 0.55))
    return _shaded("plain", _strong(rng, hues), 0.85, rng, rng.uniform(0.4, 0.8))


def wood(rng: np.random.Generator, hues: Hues) -> Look:
    colour = (rng.uniform(0.06, 0.11), rng.uniform(0.35, 0.65), rng.uniform(0.5, 0.92))
    return _shaded("wood", colour, 0.75, rng, 0.2)


def paper(rng: np.random.Generator, hues: Hues) -> Look:
    if rng.random() < 0.75:
        ground = _colour(hues.draw(rng), rng.uniform(0.3, 0.9), rng.uniform(0.4, 0.95))
        mark = _colour(hues.draw(rng), rng.uniform(0.05, 0.6), rng.uniform(0.75, 1.0))
        return Look("label", light=ground, dark=mark, gloss=rng.uniform(0.1, 0.4))
    return _shaded("plain", (0.09, rng.uniform(0.1, 0.5), rng.uniform(0.6, 0.9)), 0.93, rng, 0.05)


def foam(rng: np.random.Generator, hues: Hues) -> Look:
    grey = rng.random() < 0.4
    saturation, value = (0.02, rng.uniform(0.12, 0.95)) if grey else (rng.uniform(0.4, 0.8), rng.uniform(0.6, 0.97))
    return _shaded("pores", (hues.draw(rng), saturation, value), rng.uniform(0.5, 0.85), rng, rng.uniform(0, 0.1))


Draw = Callable[[np.random.Generator, Hues], Look]

MATERIALS: Mapping[str, Draw] = {
    "ceramic": ceramic,
    "glass": glass,
    "metal": metal,
    "soft-plastic": soft_plastic,
    "hard-plastic": hard_plastic,
    "wood": wood,
    "paper": paper,
    "foam": foam,
}
"""What draws a surface of each material of the shipped networks."""


def _peel(rng: np.random.Generator, hues: Hues) -> Look:
    ripe = _colour(rng.uniform(0.11, 0.2), rng.uniform(0.65, 0.9), rng.uniform(0.75, 0.97))
    return Look("ripening", light=ripe, dark=(122, 84, 34), gloss=rng.uniform(0.15, 0.4))


def _berry(rng: np.random.Generator, hues: Hues) -> Look:
    red = _colour(rng.uniform(0.96, 1.02) % 1, rng.uniform(0.7, 0.9), rng.uniform(0.65, 0.95))
    return Look("seeds", light=red, dark=(248, 214, 120), gloss=rng.uniform(0.2, 0.7))


def _skin(rng: np.random.Generator, hues: Hues) -> Look:
    hue = float(rng.choice([rng.uniform(0, 0.12), rng.uniform(0.2, 0.32)]))
    colour = (hue, rng.uniform(0.65, 0.95), rng.uniform(0.6, 0.95))
    return _shaded("plain", colour, 0.85, rng, rng.uniform(0.2, 0.6))


OWN: Mapping[str, Draw] = {"peel": _peel, "berry": _berry, "skin": _skin}
"""Surfaces that fruit have whatever they are made of."""

TRIMS: Mapping[str, Look] = {
    "trim": Look(light=(40, 40, 44), dark=(30, 30, 34), gloss=0.4),
    "metal": Look(light=(176, 178, 182), dark=(150, 152, 158), gloss=0.9),
    "stem": Look(light=(110, 84, 44), dark=(70, 52, 30)),
    "leaf": Look(light=(56, 132, 44), dark=(34, 92, 28)),
}
"""Surfaces of parts that are not of the whole's material."""
