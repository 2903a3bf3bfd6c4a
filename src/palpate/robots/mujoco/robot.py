"""A robot on the bench: physics gives signals, estimators make outcomes of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from palpate.errors import EvidenceError, choices, near
from palpate.network.model import Network
from palpate.outcomes import Outcome
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.noise import BenchNoise
from palpate.robots.mujoco.reading import SHIPPED, bench_object, read_roles
from palpate.robots.mujoco.repertoire import Deed, repertoire
from palpate.robots.signals import Signals

__all__ = ["Estimate", "Listener", "MujocoRobot", "Skill"]

Estimate = Callable[[Any], Outcome]
"""From the signals of a deed to the outcome."""
Listener = Callable[[str, Signals, Outcome], None]
"""Is told of an action, its signals and its outcome."""


@dataclass(frozen=True)
class Skill:
    """How an action is done, and what is made of what the sensors gave."""

    deed: Deed
    estimate: Estimate


class MujocoRobot:
    """Measures an object on a bench; to be closed, or used in a `with` statement.

    Parameters
    ----------
    skills
        Action to how it is done.
    record
        Called with action, signals and outcome after each action: to keep the raw signals.

    Attributes
    ----------
    listeners
        All who are called so; others may be added.

    Examples
    --------
    ::

        with MujocoRobot.of(network, "banana_ycb", estimates, rng=np.random.default_rng(1)) as robot:
            for step in palpate.explore(palpate.ExactBelief(network), robot):
                ...
    """

    def __init__(
        self,
        bench: Bench,
        skills: Mapping[str, Skill],
        record: Listener | None = None,
    ) -> None:
        self.bench = bench
        self._skills = dict(skills)
        self.listeners: list[Listener] = [] if record is None else [record]

    @classmethod
    def of(
        cls,
        network: Network,
        name: str,
        estimates: Mapping[str, Estimate],
        *,
        noise: BenchNoise | None = None,
        rng: np.random.Generator | None = None,
        path: str | Path = SHIPPED,
        record: Listener | None = None,
    ) -> Self:
        """Set up a bench with an object of a network.

        Parameters
        ----------
        estimates
            Action of the network to what makes an outcome of its signals; other actions are not on offer.
        path
            File of shapes and looks.

        Raises
        ------
        BenchError
            The bench cannot do one of the actions, or the object cannot be made.
        """
        deeds = repertoire(network, read_roles(path))
        for action in estimates:
            if action not in deeds:
                raise BenchError(f"the bench cannot do action {action!r}{near(action, deeds)}: {choices(deeds)}")
        skills = {action: Skill(deeds[action], estimate) for action, estimate in estimates.items()}
        return cls(Bench(bench_object(network, name, path), noise, rng), skills, record)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the graphics; may be called twice."""
        self.bench.close()

    def actions(self) -> tuple[str, ...]:
        """The actions that it has skills for."""
        return tuple(self._skills)

    def perform(self, action: str) -> Outcome:
        """Do the action in physics, and estimate its outcome.

        Raises
        ------
        EvidenceError
            The robot has no skill for it.
        """
        if action not in self._skills:
            raise EvidenceError(f"unknown action {action!r}{near(action, self._skills)}: {choices(self._skills)}")
        skill = self._skills[action]
        signals = skill.deed(self.bench)
        outcome = skill.estimate(signals)
        for listener in self.listeners:
            listener(action, signals, outcome)
        return outcome
