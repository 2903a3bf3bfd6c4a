"""Surfaces as pictures: drawn here from noise and simple shapes, the same for the same seed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = ["PATTERNS", "add_texture", "grain"]

Pixels = NDArray[np.uint8]
"""A picture, (height, width, 3)."""
Colour = tuple[float, float, float]
SIZE = 256


def add_texture(spec: mujoco.MjSpec, name: str, picture: Pixels, *, flat: bool = False) -> None:
    """Add a picture as a texture: flat over a box's top or a mesh's own coordinates, or else on all sides of a cube."""
    image = picture if flat else np.concatenate([picture] * 6)
    texture = spec.add_texture(name=name, width=image.shape[1], height=image.shape[0], nchannel=3)
    texture.type = mujoco.mjtTexture.mjTEXTURE_2D if flat else mujoco.mjtTexture.mjTEXTURE_CUBE
    texture.data = image.tobytes()


def noise(rng: np.random.Generator, shape: tuple[int, int], cell: int) -> NDArray[np.float64]:
    """Smooth noise between 0 and 1 with features of `cell` pixels; its edges meet."""
    from scipy.ndimage import gaussian_filter

    smooth = gaussian_filter(rng.standard_normal(shape), cell / 2, mode="wrap")
    return np.asarray((smooth - smooth.min()) / np.ptp(smooth))


def mix(light: Colour, dark: Colour, share: NDArray[np.float64]) -> Pixels:
    """Between two colours, by a share of the second at each pixel."""
    shares = share[..., None]
    return np.asarray(np.clip((1 - shares) * np.asarray(light) + shares * np.asarray(dark), 0, 255), dtype=np.uint8)


def grain(rng: np.random.Generator, shape: tuple[int, int], light: Colour, dark: Colour, streak: int) -> Pixels:
    """Wood: streaks along the rows."""
    from scipy.ndimage import gaussian_filter

    fine = gaussian_filter(rng.standard_normal(shape), (0.8, streak), mode="wrap")
    broad = gaussian_filter(rng.standard_normal(shape), (8, 2 * streak), mode="wrap")
    share = 0.5 * fine / fine.std() + 0.8 * broad / broad.std()
    return mix(light, dark, np.clip(0.4 + 0.22 * share, 0, 1))


def plain(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """Nearly one colour, as paint and glaze are."""
    return mix(light, dark, 0.5 * noise(rng, (SIZE, SIZE), 60))


def wood(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """Wood with its grain along one side."""
    return grain(rng, (SIZE, SIZE), light, dark, 24)


def pores(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """Foam: many small dark holes of two sizes."""
    small, large = noise(rng, (SIZE, SIZE), 3), noise(rng, (SIZE, SIZE), 9)
    share = np.clip((small - 0.60) * 6, 0, 1) + np.clip((large - 0.66) * 8, 0, 1)
    return mix(light, dark, np.clip(share, 0, 1))


def speckles(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """Enamel: a colour with scattered drops of another."""
    return mix(light, dark, np.clip((noise(rng, (SIZE, SIZE), 4) - 0.74) * 20, 0, 1))


def seeds(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """A strawberry's skin: seeds in rows, each second row shifted by half."""
    rows, columns = np.mgrid[0:SIZE, 0:SIZE].astype(float)
    step = SIZE / 9
    shifted = columns + step / 2 * (np.floor(rows / step) % 2)
    across, down = (shifted % step) - step / 2, (rows % step) - step / 2
    share = np.exp(-((across / 2.2) ** 2) - (down / 3.6) ** 2)
    return mix(light, dark, np.clip(share + 0.15 * noise(rng, (SIZE, SIZE), 30), 0, 1))


def ripening(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """A peel with brown freckles and streaks."""
    freckles = np.clip((noise(rng, (SIZE, SIZE), 5) - 0.72) * 9, 0, 1)
    return mix(light, dark, np.clip(0.7 * freckles + 0.22 * noise(rng, (SIZE, SIZE), 40), 0, 1))


def label(rng: np.random.Generator, light: Colour, dark: Colour) -> Pixels:
    """A printed carton: a ground, a band with bars like words, and a round picture below."""
    image = mix(light, light, noise(rng, (SIZE, SIZE), 60)).astype(float)
    image[26:88, 24:232] = dark
    left = 40
    while left < 200:
        width = int(rng.integers(10, 26))
        image[42:72, left : min(left + width, 216)] = light
        left += width + 8
    rows, columns = np.mgrid[0:SIZE, 0:SIZE]
    for _ in range(7):
        row, column = rng.integers(125, 225), rng.integers(40, 216)
        inside = (rows - row) ** 2 + (columns - column) ** 2 < 26**2
        edge = (rows - row) ** 2 + (columns - column) ** 2 < 22**2
        image[inside] = (176, 120, 60)
        image[edge] = (226, 178, 104)
    return np.clip(image + 4 * rng.standard_normal((SIZE, SIZE, 1)), 0, 255).astype(np.uint8)


PATTERNS: Mapping[str, Callable[[np.random.Generator, Any, Any], Pixels]] = {
    "plain": plain,
    "wood": wood,
    "pores": pores,
    "speckles": speckles,
    "seeds": seeds,
    "ripening": ripening,
    "label": label,
}
"""Patterns of surfaces by name: of two colours, the ground's and the mark's."""
