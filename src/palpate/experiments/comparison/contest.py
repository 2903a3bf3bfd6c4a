"""Methods on the same tapes: a row of scores for each of them and each number of actions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from palpate.experiments.comparison.methods import EXACT, Course, Method
from palpate.experiments.comparison.trial import Trial
from palpate.experiments.comparison.worlds import World
from palpate.experiments.engines import Engine
from palpate.experiments.running import Row
from palpate.experiments.tapes import stable_int
from palpate.inference.belief import Belief
from palpate.network.model import Network
from palpate.selection.objectives import Learn

__all__ = ["ContestTask", "method_rows", "objective_of"]

Place = tuple[tuple[str, ...], Course | None]
"""The actions taken, and the course that they are part of where its expectations are kept."""


def objective_of(network: Network) -> Learn:
    """What all methods want to learn: the categorical properties together."""
    return Learn(*(known.name for known in network.categorical))


@dataclass(frozen=True)
class ContestTask:
    """All methods on the tapes of some of a world's objects.

    Parameters
    ----------
    count
        Objects in the world.
    start, stop
        Those that this task is about.
    """

    world: World
    methods: tuple[Method, ...]
    count: int
    start: int
    stop: int
    repetitions: int
    seed: int

    @property
    def key(self) -> str:
        """World and first object."""
        return f"{self.world.name}-{self.start:05d}"

    def run(self) -> list[Row]:
        """A row for each method, tape, step and, where a method takes several courses, belief."""
        tapes = self.world.tapes(self.count, self.seed, self.start, self.stop, self.repetitions)
        network, costs_s = self.world.believed, self.world.costs_s()
        objective, seed = objective_of(network), self._engine_seed()
        priors: dict[Engine, Belief] = {}
        trials = (Trial(network, tape, objective, costs_s, seed, priors) for tape in tapes)
        return [
            row for trial in trials for method in self.methods for row in method_rows(self.world.name, method, trial)
        ]

    def _engine_seed(self) -> int:
        key = (stable_int(self.key), stable_int("engines"))
        return int(np.random.SeedSequence(self.seed, spawn_key=key).generate_state(1)[0])


def method_rows(world: str, method: Method, trial: Trial) -> Iterator[Row]:
    """The rows of a method on a tape.

    Parameters
    ----------
    world
        Its name.
    """
    tape = trial.tape
    about: Row = {"world": world, "method": method.name, "object": tape.object, "repetition": tape.repetition}
    for (taken, course), weight in sorted(_weights(method, trial).items(), key=lambda item: len(item[0][0])):
        yield {
            **about,
            "trick": tape.trick,
            "step": len(taken),
            "weight": weight,
            "used": "+".join(taken),
            "cost_s": sum(trial.costs_s[name] for name in taken),
            **_expected(trial, method, taken, course),
            **trial.scores(method.scored_by, taken),
        }


def _weights(method: Method, trial: Trial) -> dict[Place, float]:
    """What a method can come to, and how probably; where nothing was expected, beliefs that are equal are one."""
    found: dict[Place, float] = {}
    for course in method.chooser.courses(trial):
        for step in course.steps:
            taken = course.actions[:step]
            place: Place = (taken, course) if course.gains else (trial.key(method.scored_by, taken), None)
            found[place] = found.get(place, 0.0) + course.weight
    return found


def _expected(trial: Trial, method: Method, taken: tuple[str, ...], course: Course | None) -> Row:
    """What was expected of the action that led here and of those that are left [bits]."""
    names = ("expected_gain_bits", "realised_gain_bits", "best_gain_bits", "worth_bits_per_s", "information_bits")
    row: Row = dict.fromkeys(names)
    if course is None:
        return row
    left = course.gains[len(taken)]
    if left:
        row["best_gain_bits"] = max(left.values())
        row["worth_bits_per_s"] = max(gain / trial.costs_s[name] for name, gain in left.items())
    row["information_bits"] = sum(trial.gains(EXACT, taken[:i])[name] for i, name in enumerate(taken))
    if taken:
        row["expected_gain_bits"] = course.gains[len(taken) - 1][taken[-1]]
        row["realised_gain_bits"] = trial.entropy_drop_bits(method.scored_by, taken)
    return row
