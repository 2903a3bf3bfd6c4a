"""Worlds: where objects and their outcomes come from, which need not be what is believed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from palpate.experiments.comparison.changes import Change, Noise, PermutedConfusion, SkewedPrior
from palpate.experiments.tapes import Tape, draw_tape, draw_tapes, stable_int
from palpate.inference.exact import ExactBelief
from palpate.network.model import KnownObject, Network, TrueValue
from palpate.network.reading import load_network

__all__ = ["NETWORK", "World", "dealt_costs", "drawn_objects", "worlds"]

NETWORK = "household-filled"


@dataclass(frozen=True)
class World:
    """Where objects and outcomes come from; all of it can be pickled.

    Parameters
    ----------
    name
        What stands in tables.
    words
        What people read.
    network
        What is believed: a shipped network, or a TOML file.
    change
        What the world has other than believed; nothing where None.
    outliers
        Share of the outcomes that are those of another object.
    known_objects
        Whether the objects are those that the network names, and not drawn from its prior.
    costs_dealt
        Whether what tells most at the start costs most, see `dealt_costs`.
    """

    name: str
    words: str
    network: str = NETWORK
    change: Change | None = None
    outliers: float = 0.0
    known_objects: bool = False
    costs_dealt: bool = False

    @property
    def believed(self) -> Network:
        """The network that all methods believe in."""
        return _loaded(self.network)

    @property
    def actual(self) -> Network:
        """The network that objects and outcomes are drawn from."""
        return self.change.apply(self.believed) if self.change else self.believed

    def tapes(self, count: int, seed: int, start: int, stop: int, repetitions: int = 1) -> list[Tape]:
        """Tapes of the objects from `start` to before `stop`, of the `count` that there are."""
        actual = self.actual
        if self.known_objects:
            return draw_tapes(actual, list(self.believed.objects)[start:stop], repetitions, seed)
        things = drawn_objects(actual, count, _seed(seed, self.name), start, stop)
        tapes = [draw_tape(actual, thing, r, seed) for thing in things for r in range(repetitions)]
        return [self._with_outliers(tape, seed) for tape in tapes] if self.outliers else tapes

    def _with_outliers(self, tape: Tape, seed: int) -> Tape:
        """The tape with some outcomes in place of which another drawn object's stand."""
        key = (stable_int(self.name), stable_int(tape.object), tape.repetition)
        sequence = np.random.SeedSequence(seed, spawn_key=key)
        (other,) = drawn_objects(self.actual, 1, sequence)
        rng = np.random.default_rng(sequence.spawn(1)[0])
        strange = draw_tape(self.actual, replace(other, name=f"not-{tape.object}"), tape.repetition, seed).outcomes
        outcomes = {a: strange[a] if rng.random() < self.outliers else o for a, o in tape.outcomes.items()}
        return replace(tape, outcomes=outcomes)

    def costs_s(self) -> dict[str, float]:
        """Cost of every action [s]."""
        own = {name: action.cost_s for name, action in self.believed.actions.items()}
        return dealt_costs(self.believed) if self.costs_dealt else own


def worlds(network: str = NETWORK) -> tuple[World, ...]:
    """The worlds that are compared, in-model first, over a network: its name, or a TOML file."""
    found = (
        World("in-model", "objects and outcomes drawn from the network that is believed"),
        World("objects", "the objects that the network knows", known_objects=True),
        World("costed", "in-model, what tells most at the start costs most", costs_dealt=True),
        World("noise-half", "noise of readings half of what is believed", change=Noise(0.5)),
        World("noise-2", "noise of readings twice what is believed", change=Noise(2.0)),
        World("noise-4", "noise of readings four times what is believed", change=Noise(4.0)),
        World("permuted", "each state seen as its neighbour is believed to be", change=PermutedConfusion()),
        World("outliers", "10 % of the outcomes are those of another object", outliers=0.1),
        World("wrong-prior", "P(k-th category) ~ 1/k, believed uniform", change=SkewedPrior()),
    )
    return tuple(replace(world, network=network) for world in found)


def drawn_objects(
    network: Network, count: int, seed: int | np.random.SeedSequence, start: int = 0, stop: int | None = None
) -> list[KnownObject]:
    """Objects drawn from a network's prior, with all their true properties.

    Parameters
    ----------
    count
        How many are drawn; which they are depends on it.
    start, stop
        Those of them that are returned; all unless given.

    Examples
    --------
    >>> thing, = drawn_objects(load_network("household"), 1, seed=0)
    >>> thing.name, sorted(thing.truth)
    ('drawn-00000', ['category', 'density', 'elasticity', 'mass', 'material', 'volume'])
    """
    draws = ExactBelief(network).sample(count, np.random.default_rng(seed))
    plain = {name: values.tolist() for name, values in draws.items()}
    return [
        KnownObject(f"drawn-{i:05d}", "", {name: TrueValue(of[i], "measured", "drawn") for name, of in plain.items()})
        for i in range(count)[start:stop]
    ]


def dealt_costs(network: Network) -> dict[str, float]:
    """The network's costs [s], dealt anew: what tells most about the categorical properties at the start costs most.

    Examples
    --------
    >>> dealt_costs(load_network("household-filled"))["cat-vision"]
    20.0
    """
    key = tuple(known.name for known in network.categorical)
    gains: Mapping[str, float] = {a: row[key] or 0.0 for a, row in ExactBelief(network).expected_gains([key]).items()}
    costs = sorted(action.cost_s for action in network.actions.values())
    dealt = dict(zip(sorted(gains, key=gains.__getitem__), costs, strict=True))
    return {name: dealt[name] for name in network.actions}


@cache
def _loaded(name: str) -> Network:
    """The network, read once in each process."""
    return load_network(name)


def _seed(seed: int, name: str) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed, spawn_key=(stable_int(name),))
