"""From what was asked of `palpate explore` to the objects that do it."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field

import numpy as np

from palpate.cli import options
from palpate.cli.asked import Asked, RobotKind
from palpate.cli.engines import engine_words, prior_belief
from palpate.cli.replaying import Source, is_in_store, replayed
from palpate.cli.store_options import Place
from palpate.episode import About
from palpate.errors import PalpateError, choices
from palpate.inference.belief import Belief
from palpate.loop import check_robot
from palpate.network.model import KnownObject, Network
from palpate.robots.protocol import Robot
from palpate.robots.sampled import SampledRobot
from palpate.selection.objectives import Objective
from palpate.selection.policies import Policy, Random
from palpate.selection.stopping import StoppingRule

__all__ = ["Ready", "prepare"]

FORESEEING = ("look-ahead", "static")
"""Policies that need probabilities of outcomes yet to come."""


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


def prepare(asked: Asked, place: Place) -> Ready:
    """Check everything that was asked before anything is done."""
    network = asked.load()
    _check(asked, place)
    seed = secrets.randbelow(2**32) if asked.seed is None else asked.seed
    of_policy, of_robot = np.random.default_rng(seed).spawn(2)
    policy = options.policy(network, asked.policy)
    source = _source(asked, network, policy, of_robot, place)
    check_robot(network, source.robot)
    objective = options.objective(network, asked.learn or ())
    costs_s = options.costs(network, asked.costs or ())
    return Ready(
        prior=prior_belief(asked.engine, network, asked.preset, seed),
        robot=source.robot,
        known=network.objects.get(source.thing) if source.thing else None,
        objective=objective,
        policy=policy,
        stopping=options.stopping(network, asked.stop or (), asked.budget_s, asked.steps),
        costs_s=costs_s,
        rng=of_policy,
        about=_about(asked, source, objective, costs_s, seed if _is_chance(asked, policy) else None),
        source=source.source,
        notes=source.notes,
        using=source.using,
    )


def _check(asked: Asked, place: Place) -> None:
    """Refuse options that do not go together."""
    if asked.budget_s is not None:
        options.number_of("--budget", str(asked.budget_s))
    options.number_of("--pace", str(asked.pace_s))
    if asked.timeout_s is not None:
        options.number_of("--timeout", str(asked.timeout_s), least=1e-3)
    if asked.engine != "exact" and asked.policy.startswith(FORESEEING):
        raise PalpateError(
            f"--policy {asked.policy} looks ahead, which needs --engine exact, and {asked.engine} was found"
        )
    if asked.robot is not RobotKind.MUJOCO:
        for option in ("noise", "shapes", "video", "viewer"):
            if getattr(asked, option):
                raise PalpateError(f"--{option} is only for --robot mujoco, and the robot is {asked.robot.value}")
    in_store = asked.session is not None and is_in_store(asked.session)
    if (place.place or place.blobs) and not (asked.keeps or in_store):
        raise PalpateError("--store and --blobs are for --record, --live and --session store, and none was found")
    if asked.to is not None and (asked.record or not asked.live):
        found = "--record, which keeps it here," if asked.record else "no --live"
        raise PalpateError(f"--to: {found} was found, expected --live alone, which sends the episode there")
    if asked.repeat and set(_stopping_words(asked).split(",")) == {"nothing-left"}:
        raise PalpateError(
            "--repeat with --stop nothing-left would never end: add --steps, --budget or --stop gain:BITS"
        )


def _about(asked: Asked, source: Source, objective: Objective, costs_s: Mapping[str, float], seed: int | None) -> About:
    return About(
        objective=objective.name,
        policy=asked.policy,
        stopping=_stopping_words(asked),
        robot=asked.robot.value,
        object=source.thing,
        seed=seed,
        repeat=asked.repeat,
        costs_s=costs_s,
        engine=engine_words(asked.engine, asked.preset),
    )


def _is_chance(asked: Asked, policy: Policy) -> bool:
    """Whether anything depends on the seed."""
    return not asked.replay or isinstance(policy, Random) or asked.engine != "exact"


def _stopping_words(asked: Asked) -> str:
    return options.stopping_words(asked.stop or (), asked.budget_s, asked.steps)


def _source(asked: Asked, network: Network, policy: Policy, rng: np.random.Generator, place: Place) -> Source:
    """Who does the actions, as ``--robot`` says."""
    if asked.replay:
        return replayed(asked.session, asked.thing, network, place)
    if asked.session is not None:
        raise PalpateError(f"--session is only for --robot replay, and the robot is {asked.robot.value}")
    if asked.thing is None:
        raise PalpateError(f"no OBJECT was found; {choices(network.objects)}")
    if asked.robot is RobotKind.MUJOCO:
        return _on_bench(asked, asked.thing, network, policy, rng)
    robot = SampledRobot(network, asked.thing, rng)
    return Source(robot, asked.thing, f"the sensor models of the network {network.name}")


def _on_bench(asked: Asked, thing: str, network: Network, policy: Policy, rng: np.random.Generator) -> Source:
    """The robot in physics."""
    from palpate.cli.benching import bench_in_use, bench_robot

    if asked.timeout_s is not None:
        raise PalpateError("--timeout is not for --robot mujoco: its actions end by themselves")
    robot = bench_robot(network, thing, asked.noise or (), rng, asked.shapes)
    return Source(robot, thing, "the bench in physics", using=bench_in_use(robot, network, policy))
