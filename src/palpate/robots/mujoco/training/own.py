"""The bench's own objects, none of which is in any training set: the last test of what was trained."""

from __future__ import annotations

import numpy as np

from palpate.network.model import Network
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.looking import look
from palpate.robots.mujoco.reading import bench_object
from palpate.robots.mujoco.training.held_out import Examples
from palpate.robots.mujoco.training.tables import Plate

__all__ = ["own_pictures", "own_plates"]


def own_plates(network: Network) -> list[Plate]:
    """What rings of each object of a network, of the material that is true of it.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> len(own_plates(load_network("household")))
    17
    """
    things = [bench_object(network, name) for name in network.objects]
    return [Plate(_truth(network, it.name, "material"), it.substance, it.size_mm, it.wall_mm) for it in things]


def own_pictures(network: Network, looks: int, rng: np.random.Generator) -> dict[str, Examples]:
    """So many looks at each object that looks like itself, by `category` and by `material`."""
    names = [name for name, known in network.objects.items() if known.looks_like is None]
    images = []
    for name in names:
        with Bench(bench_object(network, name), rng=rng) as bench:
            images += [look(bench).image for _ in range(looks)]
    groups = np.repeat(np.arange(len(names)), looks)
    return {
        what: Examples(np.array(images), np.array([_truth(network, name, what) for name in names])[groups], groups)
        for what in ("category", "material")
    }


def _truth(network: Network, name: str, what: str) -> str:
    return str(network.object(name).truth[what].value)
