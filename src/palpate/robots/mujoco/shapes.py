"""Meshes made here: what a lathe turns, and tubes along a path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["lathe", "tube"]

Mesh = tuple[NDArray[np.float64], NDArray[np.int32]]
"""Corners, (n, 3), and the corners of each triangle, (m, 3), counterclockwise as seen from outside."""
AROUND = 48


def lathe(profile: Sequence[Sequence[float]], around: int = AROUND) -> Mesh:
    """Turn a profile about the z axis.

    Parameters
    ----------
    profile
        Points (radius, height), from the bottom of the outside upwards; it is closed by itself, along the axis where it
        begins and ends there.
    """
    points = np.asarray(profile, dtype=float)
    angles = 2 * np.pi * np.arange(around) / around
    rings = np.stack(
        [points[:, :1] * np.cos(angles), points[:, :1] * np.sin(angles), np.repeat(points[:, 1:], around, 1)], axis=2
    )
    return rings.reshape(-1, 3), _bands(len(points), around)


def tube(path: Sequence[Sequence[float]], radii: Sequence[float], around: int = 20, along: int = 40) -> Mesh:
    """Draw a tube along a smooth path through points; its radius changes smoothly between those given at the points."""
    from scipy.interpolate import CubicSpline

    at = np.linspace(0, len(path) - 1, along)
    curve = CubicSpline(np.arange(len(path)), np.asarray(path, dtype=float))
    centres, forward = curve(at), curve(at, 1)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    width = np.interp(at, np.arange(len(radii)), radii)
    # one direction across that no part of the path follows
    aside = np.eye(3)[np.argmin(np.abs(forward).max(axis=0))]
    first = np.cross(forward, aside)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(forward, first)
    angles = 2 * np.pi * np.arange(around) / around
    rings = (
        centres[:, None]
        + width[:, None, None] * np.cos(angles)[None, :, None] * first[:, None]
        + width[:, None, None] * np.sin(angles)[None, :, None] * second[:, None]
    )
    corners = np.concatenate([rings.reshape(-1, 3), centres[:1], centres[-1:]])
    start, end = len(corners) - 2, len(corners) - 1
    ring = np.arange(around)
    ahead = (ring + 1) % around
    last = (along - 1) * around
    caps = np.concatenate(
        [
            np.stack([np.full(around, start), ahead, ring], 1),
            np.stack([np.full(around, end), last + ring, last + ahead], 1),
        ]
    )
    return corners, np.concatenate([_bands(along, around), caps]).astype(np.int32)


def _bands(rings: int, around: int) -> NDArray[np.int32]:
    """Two triangles for each square between one ring and the next."""
    ring, place = np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    ahead = (place + 1) % around
    a, b = ring * around + place, ring * around + ahead
    c, d = a + around, b + around
    return np.concatenate([np.stack([a, b, d], -1), np.stack([a, d, c], -1)]).reshape(-1, 3).astype(np.int32)
