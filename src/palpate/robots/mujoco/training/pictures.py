"""Pictures of things drawn at random, by category and by material."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.robots.mujoco.training.gallery import Gallery, Sight, draw_sight
from palpate.robots.mujoco.training.held_out import Examples
from palpate.robots.mujoco.training.surfaces import Hues

__all__ = ["SIZE", "Album", "draw_sights", "photograph"]

SIZE = (160, 120)
"""Width and height of a picture as the models take it [pixels]."""
DRAWN = (320, 240)
IN_A_GALLERY = 24
PLACE_SD_MM, TURN_SD_RAD, LIGHT_SD = 10.0, 0.5, 0.15
"""How differently things stand and are lit: more than on the bench, so that its own pictures are nothing special."""
BY_NETWORK = 0.5
"""Share of things whose material is drawn as the network has it of their category; others are of any material."""


@dataclass(frozen=True, eq=False)
class Album:
    """Pictures of things, several of each.

    Attributes
    ----------
    images
        (n, height, width, 3), uint8.
    sights
        What is seen, by number of the thing.
    things
        Number of the thing in each picture, (n).
    """

    images: NDArray[np.uint8]
    sights: tuple[Sight, ...]
    things: NDArray[np.int64]

    def by(self, labels: Sequence[str]) -> Examples:
        """Examples, given a label of each thing; a thing is a group."""
        return Examples(self.images, np.array(labels)[self.things], self.things)


def draw_sights(network: Network, count: int, hues: Hues, rng: np.random.Generator, name: str) -> list[Sight]:
    """Draw things of the categories of a network, about as many of each, of materials that may be.

    Parameters
    ----------
    network
        One whose `category` and `material` are those that can be drawn.
    name
        What their names begin with.

    Raises
    ------
    PalpateError
        If these are not categorical.
    """
    category, material = network.properties["category"], network.properties["material"]
    if not (isinstance(category, CategoricalProperty) and isinstance(material, CategoricalProperty)):
        raise PalpateError(f"network {network.name!r}: expected states of category and of material")
    even = np.full(len(material.states), 1 / len(material.states))
    found = []
    for number in range(count):
        place = number % len(category.states)
        shares = BY_NETWORK * material.table[place] + (1 - BY_NETWORK) * even
        state = material.states[int(rng.choice(len(shares), p=shares / shares.sum()))]
        found.append(draw_sight(f"{name}{number}", category.states[place], state, hues, rng))
    return found


def photograph(sights: Sequence[Sight], views: int, rng: np.random.Generator) -> Album:
    """Take so many pictures of each thing, each time put down and lit a little differently."""
    images, things = [], []
    for first in range(0, len(sights), IN_A_GALLERY):
        some = sights[first : first + IN_A_GALLERY]
        with Gallery(some, DRAWN) as gallery:
            for number in range(len(some)):
                for image in _views(gallery, number, views, rng):
                    images.append(image)
                    things.append(first + number)
    return Album(np.array(images), tuple(sights), np.array(things))


def _views(gallery: Gallery, number: int, views: int, rng: np.random.Generator) -> Iterator[NDArray[np.uint8]]:
    from PIL import Image

    for _ in range(views):
        along, aside = PLACE_SD_MM * rng.standard_normal(2)
        turn_rad, bright = TURN_SD_RAD * rng.standard_normal(), np.exp(LIGHT_SD * rng.standard_normal())
        drawn = gallery.image(number, off_mm=(along, aside), turn_rad=turn_rad, bright=bright)
        yield np.asarray(Image.fromarray(drawn).resize(SIZE))
