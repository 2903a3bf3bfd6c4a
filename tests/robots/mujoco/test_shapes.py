from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.robots.mujoco.shapes import lathe, tube


def volume(mesh) -> float:
    """Signed volume by the divergence theorem; positive where triangles face outwards."""
    corners, faces = mesh
    a, b, c = (corners[faces[:, place]] for place in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def area(mesh) -> float:
    corners, faces = mesh
    a, b, c = (corners[faces[:, place]] for place in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@given(st.floats(5, 80), st.floats(5, 200))
def test_a_turned_cylinder_has_its_volume(radius: float, height: float) -> None:
    """The volume of a turned cylinder is pi r^2 h, less what the corners cut off."""
    mesh = lathe([(0, 0), (radius, 0), (radius, height), (0, height)], around=200)
    assert volume(mesh) == pytest.approx(np.pi * radius**2 * height, rel=2e-3)


def test_a_hollow_holds_its_wall_only() -> None:
    """A cup's volume is that of its wall and bottom."""
    cup = lathe([(0, 0), (40, 0), (40, 90), (37, 90), (37, 4), (0, 4)], around=200)
    assert volume(cup) == pytest.approx(np.pi * (40**2 * 90 - 37**2 * 86), rel=3e-3)


def test_a_straight_tube_is_a_cylinder() -> None:
    """A tube along a line has a cylinder's volume and surface, and is closed."""
    mesh = tube([(0, 0, 0), (30, 0, 0), (60, 0, 0), (90, 0, 0)], (10, 10, 10, 10), around=120)
    assert volume(mesh) == pytest.approx(np.pi * 10**2 * 90, rel=3e-3)
    assert area(mesh) == pytest.approx(2 * np.pi * 10 * (90 + 10), rel=3e-3)
    edges = Counter(
        tuple(sorted(edge)) for face in mesh[1].tolist() for edge in zip(face, [*face[1:], face[0]], strict=True)
    )
    assert set(edges.values()) == {2}


def test_a_bent_tube_keeps_its_width() -> None:
    """Rings of a bent tube stay at their radius from the path, without twists that pinch it."""
    corners, _ = tube([(0, 0, 0), (40, 0, 30), (80, 0, 0)], (8, 8, 8), around=16, along=30)
    rings = corners[:-2].reshape(30, 16, 3)
    np.testing.assert_allclose(np.linalg.norm(rings - rings.mean(axis=1, keepdims=True), axis=2), 8.0)
