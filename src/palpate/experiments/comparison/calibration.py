"""Whether exact beliefs are as sure as they are right, over many drawn objects."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.experiments.comparison.contest import objective_of
from palpate.experiments.comparison.methods import EXACT
from palpate.experiments.comparison.trial import Trial
from palpate.experiments.comparison.worlds import World
from palpate.experiments.running import Row

__all__ = ["CalibrationTask"]


@dataclass(frozen=True)
class CalibrationTask:
    """Exact beliefs after all actions, of some of the objects drawn from the network that is believed."""

    world: World
    count: int
    start: int
    stop: int
    seed: int

    @property
    def key(self) -> str:
        """World and first object."""
        return f"calibration-{self.world.name}-{self.start:05d}"

    def run(self) -> list[Row]:
        """A row of scores for each object."""
        network = self.world.believed
        tapes = self.world.tapes(self.count, self.seed, self.start, self.stop)
        objective, costs_s = objective_of(network), self.world.costs_s()
        trials = (Trial(network, tape, objective, costs_s, self.seed) for tape in tapes)
        about: Row = {"world": self.world.name, "method": "exact", "step": len(network.actions), "weight": 1.0}
        return [{**about, "object": t.tape.object, **t.scores(EXACT, t.actions)} for t in trials]
