"""Images that show nothing that a model could know: an empty table, noise, stripes, and pieces of pictures in disorder.

Without them a network is as sure of noise as of anything.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.training.gallery import Sight
from palpate.robots.mujoco.training.pictures import Album, photograph

__all__ = ["NOTHING", "empty_tables", "noise", "rubbish"]

NOTHING = "nothing"
"""Label of such images."""
Image = NDArray[np.uint8]
PIECE = 20


def empty_tables(count: int, rng: np.random.Generator) -> Image:
    """Pictures of the table without a thing on it, in different light, (count, height, width, 3)."""
    return photograph([Sight("none", NOTHING, NOTHING, (), 1.0)], count, rng).images


def rubbish(count: int, album: Album, rng: np.random.Generator) -> Image:
    """Images of no scene at all, of the size of an album's, (count, height, width, 3)."""
    kinds: tuple[Callable[[], Image], ...] = (
        lambda: noise(album.images.shape[1:3], rng),
        lambda: _stripes(album.images.shape[1:3], rng),
        lambda: _shuffled(album.images[rng.integers(len(album.images))], rng),
    )
    return np.array([kinds[number % len(kinds)]() for number in range(count)])


def noise(shape: tuple[int, ...], rng: np.random.Generator) -> Image:
    """Noise about some colour, from fine to coarse, in grey or in colour."""
    from scipy.ndimage import gaussian_filter

    cell = rng.choice([0.0, rng.uniform(0.5, 12)])
    channels = int(rng.choice([1, 3]))
    values = np.stack([gaussian_filter(rng.standard_normal(shape), cell) for _ in range(channels)], axis=2)
    values = rng.uniform(5, 80) * values / values.std() + rng.uniform(40, 215, channels)
    return np.broadcast_to(np.clip(values, 0, 255).astype(np.uint8), (*shape, 3)).copy()


def _stripes(shape: tuple[int, ...], rng: np.random.Generator) -> Image:
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    angle, length = rng.uniform(0, np.pi), rng.uniform(4, 60)
    share = 0.5 + 0.5 * np.sin(2 * np.pi * (rows * np.sin(angle) + columns * np.cos(angle)) / length)
    first, second = rng.uniform(0, 255, (2, 3))
    return np.asarray(first + share[..., None] * (second - first)).astype(np.uint8)


def _shuffled(image: Image, rng: np.random.Generator) -> Image:
    """A picture cut into squares that are put together anew."""
    height, width = image.shape[0] // PIECE, image.shape[1] // PIECE
    pieces = image.reshape(height, PIECE, width, PIECE, 3).swapaxes(1, 2).reshape(-1, PIECE, PIECE, 3)
    mixed = pieces[rng.permutation(len(pieces))].reshape(height, width, PIECE, PIECE, 3)
    return np.ascontiguousarray(mixed.swapaxes(1, 2).reshape(image.shape))
