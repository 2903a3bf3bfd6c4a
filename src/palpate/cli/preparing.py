"""From what was asked of `palpate explore` to the objects that do it."""

from __future__ import annotations

import secrets
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from palpate.cli import options
from palpate.cli.engines import engine_words, prior_belief
from palpate.cli.replaying import is_in_store, replayed
from palpate.cli.robot_kinds import RobotKind
from palpate.episode import About
from palpate.errors import PalpateError, choices
from palpate.inference.belief import Belief
from palpate.loop import check_robot
from palpate.network.model import KnownObject, Network
from palpate.network.reading import load_network
from palpate.robots.protocol import Robot
from palpate.robots.sampled import SampledRobot
from palpate.selection.objectives import Objective
from palpate.selection.policies import Policy, Random
from palpate.selection.stopping import StoppingRule

__all__ = ["Asked", "Ready", "prepare"]

FORESEEING = ("look-ahead", "static")
"""Policies that need probabilities of outcomes yet to come."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options of `palpate explore` as they were typed; None where they were not."""

    thing: str | None
    network: str | None
    learn: Sequence[str]
    policy: str
    stop: Sequence[str]
    budget_s: float | None
    steps: int | None
    costs: Sequence[str]
    repeat: bool
    engine: str
    preset: str | None
    robot: RobotKind
    session: str | None
    seed: int | None
    noise: Sequence[str]
    timeout_s: float | None
    log: Path | None
    plot: Path | None
    video: Path | None
    viewer: bool
    rerun: Path | None
    verbose: bool
    record: bool = False
    place: str | None = None
    blobs: str | None = None

    def load(self) -> Network:
        """The network asked for, else the one that suits the robot.

        Outcomes are simulated with household-filled, as three columns of a camera's table in household
        are empty and would tell nothing.
        """
        own = "household" if self.robot is RobotKind.REPLAY else "household-filled"
        return load_network(own if self.network is None else self.network)


@dataclass(frozen=True)
class Ready:
    """All that an exploration needs.

    Parameters
    ----------
    known
        The object explored, where the network knows it.
    about
        The same in words, for the log and the heading.
    source
        Where outcomes come from.
    notes
        Decisions taken in recording the session that is replayed.
    using
        What the robot holds while it explores, to be let go of afterwards.
    """

    prior: Belief
    robot: Robot
    known: KnownObject | None
    objective: Objective
    policy: Policy
    stopping: StoppingRule
    costs_s: Mapping[str, float]
    rng: np.random.Generator
    about: About
    source: str
    notes: tuple[str, ...] = ()
    using: AbstractContextManager[object] = field(default_factory=nullcontext)


@dataclass(frozen=True)
class _Acting:
    """The robot, the object that it measures, where outcomes come from, and what was decided about them."""

    robot: Robot
    thing: str | None
    source: str
    notes: tuple[str, ...] = ()
    using: AbstractContextManager[object] = field(default_factory=nullcontext)


def prepare(asked: Asked) -> Ready:
    """Check everything that was asked before anything is done."""
    network = asked.load()
    if asked.budget_s is not None:
        options.number_of("--budget", str(asked.budget_s))
    if asked.timeout_s is not None:
        options.number_of("--timeout", str(asked.timeout_s), least=1e-3)
    if asked.engine != "exact" and asked.policy.startswith(FORESEEING):
        raise PalpateError(
            f"--policy {asked.policy} looks ahead, which needs --engine exact, and {asked.engine} was found"
        )
    in_store = asked.session is not None and is_in_store(asked.session)
    if (asked.place or asked.blobs) and not (asked.record or in_store):
        raise PalpateError("--store and --blobs are for --record and --session store, and neither was found")
    words = options.stopping_words(asked.stop, asked.budget_s, asked.steps)
    if asked.repeat and set(words.split(",")) == {"nothing-left"}:
        raise PalpateError(
            "--repeat with --stop nothing-left would never end: add --steps, --budget or --stop gain:BITS"
        )
    seed = secrets.randbelow(2**32) if asked.seed is None else asked.seed
    of_policy, of_robot = np.random.default_rng(seed).spawn(2)
    acting = _acting(asked, network, of_robot)
    check_robot(network, acting.robot)
    objective = options.objective(network, asked.learn)
    costs_s = options.costs(network, asked.costs)
    policy = options.policy(network, asked.policy)
    chance = asked.robot is not RobotKind.REPLAY or isinstance(policy, Random) or asked.engine != "exact"
    about = About(
        objective=objective.name,
        policy=asked.policy,
        stopping=words,
        robot=asked.robot.value,
        object=acting.thing,
        seed=seed if chance else None,
        repeat=asked.repeat,
        costs_s=costs_s,
        engine=engine_words(asked.engine, asked.preset),
    )
    return Ready(
        prior=prior_belief(asked.engine, network, asked.preset, seed),
        robot=acting.robot,
        known=network.objects.get(acting.thing) if acting.thing else None,
        objective=objective,
        policy=policy,
        stopping=options.stopping(network, asked.stop, asked.budget_s, asked.steps),
        costs_s=costs_s,
        rng=of_policy,
        about=about,
        source=acting.source,
        notes=acting.notes,
        using=acting.using,
    )


def _acting(asked: Asked, network: Network, rng: np.random.Generator) -> _Acting:
    """Who does the actions, as ``--robot`` says."""
    if asked.robot is not RobotKind.MUJOCO:
        for option, given in (("--noise", asked.noise), ("--video", asked.video), ("--viewer", asked.viewer)):
            if given:
                raise PalpateError(f"{option} is only for --robot mujoco, and the robot is {asked.robot.value}")
    if asked.robot is RobotKind.REPLAY:
        found = replayed(asked.session, asked.thing, network, asked.place, asked.blobs)
        return _Acting(found.robot, found.thing, found.source, found.notes)
    if asked.session is not None:
        raise PalpateError(f"--session is only for --robot replay, and the robot is {asked.robot.value}")
    if asked.thing is None:
        raise PalpateError(f"no OBJECT was found; {choices(network.objects)}")
    if asked.robot is RobotKind.MUJOCO:
        return _on_bench(asked, asked.thing, network, rng)
    return _Acting(
        SampledRobot(network, asked.thing, rng), asked.thing, f"the sensor models of the network {network.name}"
    )


def _on_bench(asked: Asked, thing: str, network: Network, rng: np.random.Generator) -> _Acting:
    """The robot in physics."""
    from palpate.cli.benching import bench_in_use, bench_robot

    if asked.timeout_s is not None:
        raise PalpateError("--timeout is not for --robot mujoco: its actions end by themselves")
    robot = bench_robot(network, thing, asked.noise, rng)
    return _Acting(robot, thing, "the bench in physics", using=bench_in_use(robot, network))
