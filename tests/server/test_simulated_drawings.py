"""Drawings of the example: light that is followed by distances meets the surfaces, and each kind looks its own."""

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from palpate.network.reading import load_network
from palpate.server.simulated_drawings import COLOURS, SHAPES, drawing, kind_of


def pixels(picture: bytes) -> np.ndarray:
    """Of a PNG, (rows, columns, 3)."""
    return np.asarray(Image.open(BytesIO(picture)), float)


@pytest.mark.parametrize("category", SHAPES)
def test_no_step_goes_beyond_a_surface(category: str) -> None:
    """Two points are at least as far apart as their distances to the surface differ."""
    rng = np.random.default_rng(1)
    first = rng.uniform([-2, -1, -2], [2, 3, 2], (20_000, 3))
    second = first + rng.normal(0.0, 0.2, first.shape)
    apart = np.linalg.norm(first - second, axis=1)
    shape = SHAPES[category]
    assert np.all(np.abs(shape(first) - shape(second)) <= apart * (1 + 1e-9))


@pytest.mark.parametrize("category", SHAPES)
def test_each_stands_on_the_table(category: str) -> None:
    """Nothing of it is below the table, and something is just above."""
    rng = np.random.default_rng(2)
    below = rng.uniform([-2, -1, -2], [2, -0.01, 2], (5_000, 3))
    above = rng.uniform([-1.3, 0.01, -1.3], [1.3, 0.05, 1.3], (5_000, 3))
    assert SHAPES[category](below).min() > 0
    assert SHAPES[category](above).min() < 0


def test_each_kind_looks_its_own_and_the_same_each_time() -> None:
    """Shapes differ between categories, and colours between materials."""
    shapes = [drawing(category, "wood") for category in SHAPES]
    colours = [drawing("box", material) for material in COLOURS]
    assert len(set(shapes)) == len(SHAPES)
    assert len(set(colours)) == len(COLOURS)
    assert shapes == [drawing(category, "wood") for category in SHAPES]


def test_a_picture_shows_a_thing_in_its_colour_on_a_table() -> None:
    """In the middle is the colour of the material, in a corner the table."""
    found = pixels(drawing("box", "hard-plastic"))
    assert found.shape == (180, 240, 3)
    red, green, blue = found[90, 110]
    assert red > 1.5 * max(green, blue) > 0
    assert found[2, 2] == pytest.approx([236, 233, 224], abs=2)


def test_what_has_no_shape_is_a_ball() -> None:
    """A category or a material that nobody drew is no error."""
    assert drawing("sofa", "felt") == drawing("fruit", "felt") != drawing("fruit", "wood")


def test_objects_tell_what_they_are_drawn_by() -> None:
    """The truth of a network's object names both."""
    assert kind_of(load_network("household-filled").objects["ceramic_mug"]) == ("mug", "ceramic")
