"""The paper's experiment as tasks: each engine explores each tape with every objective, and at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.experiments.branches import Branches
from palpate.experiments.engines import Engine, Exact
from palpate.experiments.reproduction.arms import Arm
from palpate.experiments.reproduction.episodes import Goal, episode
from palpate.experiments.reproduction.paper import Case
from palpate.experiments.reproduction.rows import SHOWN, Writer, gain_columns
from palpate.experiments.shared import SharedNetwork
from palpate.experiments.tapes import Tape, stable_int
from palpate.experiments.workers import Row
from palpate.outcomes import Failed
from palpate.selection.policies import Greedy, Random
from palpate.selection.stopping import GainBelow, NetGainBelow, StoppingRule

__all__ = ["GREEDY", "RANDOM", "START", "StartTask", "TapeTask", "arms_of"]

GREEDY, RANDOM = "greedy", "random"
"""How actions are chosen: names of arms in the tables."""

START = "start"
"""Name of the arm that only says what actions are expected to gain before any is taken."""

LEAST_GAIN_BITS = 0.05
"""Expected gain below which the exact arms stop."""


def arms_of(engine: Engine) -> tuple[Arm, Arm]:
    """The arms of an engine: the action with the largest expected gain, and random ones.

    Exact gains are never negative, and the exact arms stop below 0.05 bits; those of message passing
    stop by the paper's rule, when no gain is above zero.
    """
    stopping: StoppingRule = GainBelow(LEAST_GAIN_BITS) if isinstance(engine, Exact) else NetGainBelow(0.0)
    return Arm(GREEDY, engine, Greedy(), stopping), Arm(RANDOM, engine, Random(), stopping)


@dataclass(frozen=True)
class TapeTask:
    """All explorations of one tape by one engine.

    Parameters
    ----------
    goals
        The objectives; random choices are the same for all of them.
    cases
        What is drawn run by run: at the end of a run its row holds the belief itself, too.
    seed
        Of the whole experiment: the task's own follow from it and the tape's name.
    """

    shared: SharedNetwork
    tape: Tape
    engine: Engine
    goals: tuple[Goal, ...]
    cases: tuple[Case, ...]
    seed: int

    @property
    def key(self) -> str:
        """Network, engine, object and repetition."""
        return f"{self.shared.network.name}.{self.engine.name}.{self.tape.object}.{self.tape.repetition}"

    def run(self) -> list[Row]:
        """A row per arm, objective and step, from before the first action to after the last one."""
        network, tape = self.shared.network, self.tape
        properties = tuple(dict.fromkeys(name for goal in self.goals for name in goal.properties))
        (engine_seed,) = self._seeds("engine").generate_state(1).tolist()
        branches = Branches(network, self.engine, tape, engine_seed)
        writer = Writer(branches, properties)
        about = {
            "network": network.name,
            "engine": self.engine.name,
            "object": tape.object,
            "repetition": tape.repetition,
            "trick": tape.trick,
            **{f"true_{name}": tape.truth.get(name) for name in properties},
        }
        return [
            {**about, "arm": arm.name, "objective": goal.name, **row}
            for arm in arms_of(self.engine)
            for goal in self.goals
            for row in self._rows(branches, writer, arm, goal)
        ]

    def _rows(self, branches: Branches, writer: Writer, arm: Arm, goal: Goal) -> list[Row]:
        shown = arm.name == GREEDY and Case(self.tape.object, goal.name) in self.cases
        # the same chance for every objective and engine: random orders are paired
        rng = np.random.default_rng(self._seeds("choices"))
        empty: Row = dict.fromkeys(SHOWN)
        return [
            {
                **writer.row(goal, point, realised=arm.name == GREEDY),
                **(writer.shown(goal, point) if shown and not point.gains_bits else empty),
            }
            for point in episode(branches, arm, goal, rng)
        ]

    def _seeds(self, purpose: str) -> np.random.SeedSequence:
        key = (stable_int(self.tape.object), self.tape.repetition, stable_int(purpose))
        return np.random.SeedSequence(self.seed, spawn_key=key)


@dataclass(frozen=True)
class StartTask:
    """What an engine expects actions to gain before any is taken."""

    shared: SharedNetwork
    engine: Engine
    goals: tuple[Goal, ...]
    seed: int

    @property
    def key(self) -> str:
        """Network and engine."""
        return f"{self.shared.network.name}.{self.engine.name}.start"

    def run(self) -> list[Row]:
        """A row per objective."""
        network = self.shared.network
        tape = Tape("", 0, dict.fromkeys(network.actions, Failed("not taken")), {})
        branches = Branches(network, self.engine, tape, self.seed)
        about: Row = {"network": network.name, "engine": self.engine.name, "arm": START, "step": 0, "stopped": False}
        return [
            {**about, "objective": goal.name, **gain_columns(branches.gains((), goal.properties), network)}
            for goal in self.goals
        ]
