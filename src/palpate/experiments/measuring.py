"""What robots measure on known objects, each action several times: once, and then kept."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from palpate.evidence import format_item, parse_item
from palpate.experiments.running import Row, gathered
from palpate.experiments.shared import SharedNetwork
from palpate.experiments.tapes import stable_int
from palpate.fitting.robot_data import Measured
from palpate.robots.protocol import Robot
from palpate.robots.sampled import SampledRobot
from palpate.robots.trial import attempt

__all__ = ["InPhysics", "Lab", "MeasureTask", "Sampled", "measure_tasks", "measurements"]


class Lab(Protocol):
    """Where a robot meets an object; it can be pickled."""

    def robot(self, thing: str, rng: np.random.Generator) -> AbstractContextManager[Robot]:
        """A robot before an object, all of whose chance is from a generator."""


@dataclass(frozen=True)
class Sampled:
    """Outcomes are drawn from a network's sensors."""

    network: SharedNetwork

    @contextmanager
    def robot(self, thing: str, rng: np.random.Generator) -> Iterator[Robot]:
        """A robot that draws for an object of the network."""
        yield SampledRobot(self.network.network, thing, rng)


@dataclass(frozen=True)
class InPhysics:
    """The bench in physics, with what a network knows of the objects."""

    network: SharedNetwork

    @contextmanager
    def robot(self, thing: str, rng: np.random.Generator) -> Iterator[Robot]:
        """A bench with an object of the network on it."""
        from palpate.robots.mujoco.estimates import estimates
        from palpate.robots.mujoco.robot import MujocoRobot

        network = self.network.network
        with MujocoRobot.of(network, thing, estimates(network), rng=rng) as robot:
            yield robot


@dataclass(frozen=True)
class MeasureTask:
    """One object, on which each action is done several times.

    Parameters
    ----------
    place
        Of the object among all of them.
    actions
        All that the robot offers where there are none.
    """

    lab: Lab
    place: int
    thing: str
    actions: tuple[str, ...]
    times: int
    seed: int

    @property
    def key(self) -> str:
        """The object's place."""
        return f"object-{self.place:05d}"

    def run(self) -> list[Row]:
        """A row for each outcome, the actions in turn."""
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(stable_int(self.thing),)))
        with self.lab.robot(self.thing, rng) as robot:
            offered = tuple(robot.actions())
            turn = [action for action in self.actions or offered if action in offered]
            return [
                {"object": self.thing, "action": action, "repetition": repetition, "outcome": _told(robot, action)}
                for repetition in range(self.times)
                for action in turn
            ]


def measure_tasks(
    lab: Lab, things: Sequence[str], *, actions: Sequence[str] = (), times: int, seed: int
) -> list[MeasureTask]:
    """The tasks of measuring objects; what an object gives does not depend on which others there are."""
    return [MeasureTask(lab, place, thing, tuple(actions), times, seed) for place, thing in enumerate(things)]


def measurements(folder: str | Path) -> Iterator[Measured]:
    """What was measured, from the folder that `palpate.experiments.running.run_tasks` ran the tasks in.

    Raises
    ------
    PalpateError
        The folder holds no run, or one that is not complete.
    """
    for row in gathered(folder).to_pylist():
        action, outcome = parse_item(json.loads(row["outcome"]))
        yield Measured(row["object"], action, outcome)


def _told(robot: Robot, action: str) -> str:
    return json.dumps(format_item(action, attempt(robot, action)))
