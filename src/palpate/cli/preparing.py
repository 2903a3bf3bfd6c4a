"""From what was asked of `palpate explore` to the objects that do it."""

from __future__ import annotations

import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.cli import options
from palpate.cli.engines import engine_words, prior_belief
from palpate.episode import About, read_episode
from palpate.errors import PalpateError, choices
from palpate.inference.belief import Belief
from palpate.logfile import EPISODE_FORMAT, SESSION_FORMAT, read_lines
from palpate.loop import check_robot
from palpate.network.model import KnownObject, Network
from palpate.network.reading import load_network
from palpate.robots.protocol import Robot
from palpate.robots.replay import ReplayRobot
from palpate.robots.sampled import SampledRobot
from palpate.robots.session import read_session, shipped_session
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
    replay: bool
    session: Path | None
    seed: int | None
    timeout_s: float | None
    log: Path | None
    plot: Path | None
    verbose: bool

    def load(self) -> Network:
        """The network asked for, else the one that suits the robot.

        Outcomes are drawn from household-filled, as three columns of a camera's table in household
        are empty and would tell nothing.
        """
        return load_network(
            ("household" if self.replay else "household-filled") if self.network is None else self.network
        )


@dataclass(frozen=True)
class Ready:
    """All that an exploration needs.

    Parameters
    ----------
    known
        The object explored, where the network knows it.
    about
        The same in words, for the log and the heading.
    notes
        Decisions taken in recording the session that is replayed.
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
    notes: tuple[str, ...] = ()


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
    words = options.stopping_words(asked.stop, asked.budget_s, asked.steps)
    if asked.repeat and set(words.split(",")) == {"nothing-left"}:
        raise PalpateError(
            "--repeat with --stop nothing-left would never end: add --steps, --budget or --stop gain:BITS"
        )
    seed = secrets.randbelow(2**32) if asked.seed is None else asked.seed
    of_policy, of_robot = np.random.default_rng(seed).spawn(2)
    robot, thing, notes = _replayed(asked) if asked.replay else _sampled(asked, network, of_robot)
    check_robot(network, robot)
    objective = options.objective(network, asked.learn)
    costs_s = options.costs(network, asked.costs)
    policy = options.policy(network, asked.policy)
    chance = not asked.replay or isinstance(policy, Random) or asked.engine != "exact"
    about = About(
        objective=objective.name,
        policy=asked.policy,
        stopping=words,
        robot="replay" if asked.replay else "sampled",
        object=thing,
        seed=seed if chance else None,
        repeat=asked.repeat,
        costs_s=costs_s,
        engine=engine_words(asked.engine, asked.preset),
    )
    return Ready(
        prior=prior_belief(asked.engine, network, asked.preset, seed),
        robot=robot,
        known=network.objects.get(thing) if thing else None,
        objective=objective,
        policy=policy,
        stopping=options.stopping(network, asked.stop, asked.budget_s, asked.steps),
        costs_s=costs_s,
        rng=of_policy,
        about=about,
        notes=notes,
    )


def _sampled(asked: Asked, network: Network, rng: np.random.Generator) -> tuple[Robot, str, tuple[str, ...]]:
    if asked.session is not None:
        raise PalpateError("--session is only for --robot replay, and the robot is sampled")
    if asked.thing is None:
        raise PalpateError(f"no OBJECT was found; {choices(network.objects)}")
    return SampledRobot(network, asked.thing, rng), asked.thing, ()


def _replayed(asked: Asked) -> tuple[Robot, str | None, tuple[str, ...]]:
    """The robot that replays, the object its outcomes are of, and what was decided in recording them."""
    if asked.session is None:
        if asked.thing is None:
            raise PalpateError("no OBJECT was found, expected the object whose session is replayed, or --session FILE")
        session = shipped_session(asked.thing)
        return ReplayRobot(session.recorded), session.object, session.all_decisions
    recorded_of, notes = _about(asked.session)
    if asked.thing not in (None, recorded_of):
        raise PalpateError(f"{asked.session} is of the object {recorded_of!r}, expected one of {asked.thing!r}")
    return ReplayRobot.read(asked.session), recorded_of, notes


def _about(path: Path) -> tuple[str | None, tuple[str, ...]]:
    """The object a session or an episode log is of, and the decisions it tells."""
    header = read_lines(path, SESSION_FORMAT, EPISODE_FORMAT)[0]
    if header.record["format"] == EPISODE_FORMAT:
        return read_episode(path).about.object, ()
    session = read_session(path)
    return session.object, session.all_decisions
