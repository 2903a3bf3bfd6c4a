"""Beliefs and gains along a tape, each worked out once however many explorations pass it."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.errors import EvidenceError
from palpate.experiments.engines import Engine
from palpate.experiments.tapes import Tape
from palpate.inference.belief import Belief
from palpate.loop import learn
from palpate.network.model import Network
from palpate.outcomes import Outcome

__all__ = ["Branches"]

Taken = tuple[str, ...]
"""Actions in the order in which they were taken."""


class Branches:
    """What an engine believes after each sequence of a tape's actions.

    Where the order of evidence does not matter to the engine, the beliefs after the same actions are
    one, with the evidence in the network's order.

    Parameters
    ----------
    seed
        Of the engine's own chance.
    """

    def __init__(self, network: Network, engine: Engine, tape: Tape, seed: int) -> None:
        self.network, self.tape = network, tape
        self._order = tuple(name for name in network.actions if name in tape.outcomes)
        self._ordered = engine.order_matters
        self._beliefs: dict[Taken, Belief] = {(): engine.prior(network, seed)}
        self._outcomes: dict[Taken, Outcome] = {}
        self._gains: dict[tuple[Taken, str], dict[str, float]] = {}
        self._realised: dict[tuple[Taken, str, str], float | None] = {}
        self._out_of_order: dict[Taken, Belief] = {}

    def belief(self, taken: Taken) -> Belief:
        """The belief after these actions."""
        return self._beliefs[self._reached(taken)]

    def outcome(self, taken: Taken) -> Outcome:
        """What the last of these actions returned, as the belief used it: failed where it could not."""
        key = self._reached(taken)
        return self._outcomes[key[: key.index(taken[-1]) + 1]]

    def realised(self, taken: Taken, name: str) -> float | None:
        """Gain that the last of these actions realised about a property [bits]; None where there is none."""
        before = self._reached(taken[:-1])
        key = (before, taken[-1], name)
        if key not in self._realised:
            self._realised[key] = self._beliefs[before].realised_gain(self._next(before, taken[-1]), name)
        return self._realised[key]

    def _next(self, before: Taken, action: str) -> Belief:
        """The belief one outcome after another, its evidence in the order taken: what gains are asked of."""
        taken = (*before, action)
        if self._reached(taken) == taken:
            return self._beliefs[taken]
        if taken not in self._out_of_order:
            self._out_of_order[taken] = learn(self._beliefs[before], action, self.tape.outcomes[action])[2]
        return self._out_of_order[taken]

    def left(self, taken: Taken) -> Taken:
        """The actions that can still be taken."""
        return tuple(action for action in self._order if action not in taken)

    def gains(self, taken: Taken, properties: Sequence[str]) -> dict[str, float]:
        """Expected gain of each action that is left about properties, summed [bits].

        Raises
        ------
        EvidenceError
            The engine cannot say what an action tells about a property.
        """
        rows = [self._gains_about(self._reached(taken), name) for name in properties]
        return {action: sum(row[action] for row in rows) for action in self.left(taken)}

    def _gains_about(self, key: Taken, name: str) -> dict[str, float]:
        if (key, name) not in self._gains:
            found = self._beliefs[key].expected_gains([name], self.left(key))
            self._gains[key, name] = {action: _known(action, name, row[name]) for action, row in found.items()}
        return self._gains[key, name]

    def _reached(self, taken: Taken) -> Taken:
        """The key of the belief after these actions, worked out with all on the way there."""
        key = taken if self._ordered else tuple(action for action in self._order if action in taken)
        if key not in self._beliefs:
            before = self._beliefs[self._reached(key[:-1])]
            self._outcomes[key], _, self._beliefs[key] = learn(before, key[-1], self.tape.outcomes[key[-1]])
        return key


def _known(action: str, name: str, bits: float | None) -> float:
    if bits is None:
        raise EvidenceError(
            f"the engine cannot say what action {action!r} tells about {name!r}: choose other properties or another one"
        )
    return bits
