"""One tape under all engines: beliefs, gains and scores, each worked out once however many methods pass it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from palpate.experiments.branches import Branches
from palpate.experiments.comparison.scores import scores
from palpate.experiments.engines import Engine
from palpate.experiments.running import Row
from palpate.experiments.tapes import Tape
from palpate.inference.belief import Belief
from palpate.network.model import Network
from palpate.selection.objectives import Learn

__all__ = ["Trial"]

Taken = tuple[str, ...]


class Trial:
    """What engines believe of a tape, whatever the actions taken.

    Parameters
    ----------
    objective
        What methods want to learn.
    costs_s
        Cost of every action [s].
    seed
        Of the engines' own chance.
    priors
        Beliefs without evidence that trials of the same network and seed share, with what they have
        worked out.
    """

    def __init__(
        self,
        network: Network,
        tape: Tape,
        objective: Learn,
        costs_s: Mapping[str, float],
        seed: int,
        priors: dict[Engine, Belief] | None = None,
    ) -> None:
        self.network, self.tape, self.objective, self.costs_s, self.seed = network, tape, objective, costs_s, seed
        self._priors = {} if priors is None else priors
        self._branches: dict[Engine, Branches] = {}
        self._gains: dict[tuple[Engine, Taken], Mapping[str, float]] = {}
        self._scores: dict[tuple[Engine, Taken], Row] = {}

    @property
    def actions(self) -> Taken:
        """The actions on the tape, in the order of the network."""
        return tuple(name for name in self.network.actions if name in self.tape.outcomes)

    def left(self, taken: Taken) -> Taken:
        """The actions that can still be taken."""
        return tuple(name for name in self.actions if name not in taken)

    def key(self, engine: Engine, taken: Taken) -> Taken:
        """What the belief after these actions depends on: their order only where it matters to the engine."""
        return taken if engine.order_matters else tuple(name for name in self.actions if name in taken)

    def belief(self, engine: Engine, taken: Taken) -> Belief:
        """The belief after these actions."""
        if engine not in self._branches:
            self._branches[engine] = Branches(self.network, _Begun(engine, self._priors), self.tape, self.seed)
        return self._branches[engine].belief(taken)

    def gains(self, engine: Engine, taken: Taken) -> Mapping[str, float]:
        """Expected gain for the objective [bits] of each action that is left."""
        key = engine, self.key(engine, taken)
        if key not in self._gains:
            self._gains[key] = self.objective.gains(self.belief(engine, taken), self.left(taken))
        return self._gains[key]

    def entropy_drop_bits(self, engine: Engine, taken: Taken) -> float | None:
        """Fall of the objective's entropy by the last of these actions [bits]."""
        return self.objective.entropy_drop(self.belief(engine, taken[:-1]), self.belief(engine, taken))

    def scores(self, engine: Engine, taken: Taken) -> Row:
        """The scores of the belief after these actions."""
        key = engine, self.key(engine, taken)
        if key not in self._scores:
            self._scores[key] = scores(self.belief(engine, taken), self.tape.truth)
        return self._scores[key]


@dataclass(frozen=True)
class _Begun:
    """An engine whose belief without evidence is kept, with the gains that it has worked out."""

    engine: Engine
    priors: dict[Engine, Belief]

    @property
    def name(self) -> str:
        return self.engine.name

    @property
    def order_matters(self) -> bool:
        return self.engine.order_matters

    def prior(self, network: Network, seed: int) -> Belief:
        if self.engine not in self.priors:
            self.priors[self.engine] = self.engine.prior(network, seed)
        return self.priors[self.engine]
