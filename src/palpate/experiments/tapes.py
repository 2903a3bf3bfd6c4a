"""Tapes: every action's outcome of one object, drawn once, so that all methods see the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from palpate.errors import EvidenceError, choices, near
from palpate.network.model import KnownObject, Network
from palpate.outcomes import Outcome
from palpate.robots.sampled import SampledRobot

__all__ = ["Tape", "TapeRobot", "draw_tape", "draw_tapes", "stable_int"]


@dataclass(frozen=True)
class Tape:
    """Every action's outcome of one object.

    Parameters
    ----------
    object
        Name of the object.
    repetition
        0 for the first tape of the object.
    outcomes
        Action to what it returns whenever it is taken; actions that are not here cannot be taken.
    truth
        True properties that are known: those that beliefs are compared with.
    trick
        Whether the object looks like another one.
    """

    object: str
    repetition: int
    outcomes: Mapping[str, Outcome]
    truth: Mapping[str, str | float]
    trick: bool = False


class TapeRobot:
    """A robot that returns what is on a tape.

    Examples
    --------
    >>> from palpate.outcomes import Label
    >>> robot = TapeRobot(Tape("mug", 0, {"cat-vision": Label("mug")}, {"category": "mug"}))
    >>> robot.actions(), robot.perform("cat-vision").label
    (('cat-vision',), 'mug')
    """

    def __init__(self, tape: Tape) -> None:
        self._outcomes = tape.outcomes

    def actions(self) -> tuple[str, ...]:
        """The actions on the tape."""
        return tuple(self._outcomes)

    def perform(self, action: str) -> Outcome:
        """Return the action's outcome; EvidenceError if it is not on the tape."""
        if action not in self._outcomes:
            raise EvidenceError(f"unknown action {action!r}{near(action, self._outcomes)}: {choices(self._outcomes)}")
        return self._outcomes[action]


def draw_tapes(network: Network, objects: Sequence[str], repetitions: int, seed: int) -> list[Tape]:
    """Tapes of some of a network's objects, drawn from its sensor models.

    True properties that are stand-ins are simulated and not scored. A tape depends on the seed, the
    object's name and the repetition alone, whatever else is drawn.

    Parameters
    ----------
    objects
        Names of objects of the network.
    repetitions
        Tapes of each object.

    Returns
    -------
    list of Tape
        Object by object.

    Examples
    --------
    >>> import palpate
    >>> network = palpate.load_network("household-filled")
    >>> (tape,) = draw_tapes(network, ["banana"], 1, seed=0)
    >>> list(tape.outcomes), "material" in tape.truth
    (['cat-vision', 'mat-vision', 'mat-sound', 'squeezing', 'weighing'], False)
    """
    return [
        draw_tape(network, network.object(name), repetition, seed)
        for name in objects
        for repetition in range(repetitions)
    ]


def draw_tape(network: Network, thing: KnownObject, repetition: int, seed: int) -> Tape:
    """One tape of a known object, each action's outcome from a generator of its own."""
    outcomes = {}
    for action in network.actions:
        key = (stable_int(thing.name), repetition, stable_int(action))
        robot = SampledRobot(network, thing, np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key)))
        if action in robot.actions():
            outcomes[action] = robot.perform(action)
    truth = {name: true.value for name, true in thing.truth.items() if true.scored}
    return Tape(thing.name, repetition, outcomes, truth, thing.is_trick)


def stable_int(name: str) -> int:
    """A whole number for a name, the same in every process, for `numpy.random.SeedSequence`.

    Examples
    --------
    >>> stable_int("banana")
    59467727
    """
    return crc32(name.encode())
