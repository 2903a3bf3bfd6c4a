"""The comparison: which worlds, how many objects, and which methods on them."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.experiments.comparison.calibration import CalibrationTask
from palpate.experiments.comparison.contest import ContestTask
from palpate.experiments.comparison.methods import Method, all_methods, few_methods, methods_on_costs
from palpate.experiments.comparison.optimum import OptimumTask
from palpate.experiments.comparison.worlds import NETWORK, World, worlds
from palpate.experiments.running import Task

__all__ = ["FULL", "IN_MODEL", "QUICK", "Size", "calibration_tasks", "comparison_tasks"]

CALIBRATION_CHUNK = 500
IN_MODEL = "in-model"


@dataclass(frozen=True)
class Size:
    """How much is run.

    Parameters
    ----------
    in_model, costed, changed
        Objects drawn in the world in which all is as believed, in the one with other costs, and in
        each of those that are not as believed.
    repetitions
        Tapes of each of the objects that the network knows.
    depth
        Actions up to which the optimum is worked out.
    methods
        What is compared on the in-model world and on the known objects.
    chunk
        Tapes in a task.
    """

    in_model: int
    costed: int
    changed: int
    repetitions: int
    depth: int
    methods: tuple[Method, ...]
    chunk: int = 10

    def contest(self, world: World, seed: int) -> list[Task]:
        """The tasks of one world."""
        if world.known_objects:
            return self._chunks(world, self.methods, len(world.believed.objects), self.repetitions, seed)
        if world.costs_dealt:
            return self._chunks(world, methods_on_costs(), self.costed, 1, seed)
        if world.name == IN_MODEL:
            return self._chunks(world, self.methods, self.in_model, 1, seed)
        return self._chunks(world, few_methods()[:4], self.changed, 1, seed)

    def _chunks(self, world: World, methods: tuple[Method, ...], count: int, repetitions: int, seed: int) -> list[Task]:
        size = max(1, self.chunk // repetitions)
        return [
            ContestTask(world, methods, count, start, min(start + size, count), repetitions, seed)
            for start in range(0, count, size)
        ]


QUICK = Size(24, 6, 3, 1, 2, few_methods()[:-1], chunk=6)
"""Under a minute: the primary contrast and what takes it apart, on few objects."""
FULL = Size(300, 150, 100, 5, 4, all_methods())
"""All methods; half an hour on two processors."""


def comparison_tasks(size: Size, seed: int, network: str = NETWORK) -> list[Task]:
    """The tasks of a comparison: the optimum, which takes longest, then world by world."""
    found = worlds(network)
    optimum = OptimumTask(found[0], size.depth)
    return [optimum, *(task for world in found for task in size.contest(world, seed))]


def calibration_tasks(count: int, seed: int, network: str = NETWORK) -> list[Task]:
    """The tasks of a calibration over objects drawn from the network that is believed."""
    world = worlds(network)[0]
    starts = range(0, count, CALIBRATION_CHUNK)
    return [CalibrationTask(world, count, start, min(start + CALIBRATION_CHUNK, count), seed) for start in starts]
