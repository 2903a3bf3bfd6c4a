"""Engines as small values: what an experiment needs to know of an engine to begin a belief with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from palpate.inference.belief import Belief
from palpate.inference.exact import ExactBelief
from palpate.inference.message_passing.settings import Settings
from palpate.network.model import Network

__all__ = ["PRESETS", "Engine", "Exact", "MessagePassing", "engine_words"]

PRESETS = {
    "as-released": Settings.as_released(),
    "repaired": Settings.repaired(),
    "as-written": Settings.as_written(),
}
"""The presets of message passing by the names that people use."""


class Engine(Protocol):
    """Begins beliefs; it can be pickled and compared."""

    @property
    def name(self) -> str:
        """What stands in tables."""

    @property
    def order_matters(self) -> bool:
        """Whether the order of evidence changes beliefs."""

    def prior(self, network: Network, seed: int) -> Belief:
        """The belief without evidence; `seed` is of the engine's own chance, where it has any."""


@dataclass(frozen=True)
class Exact:
    """The exact engine; it has no chance of its own."""

    @property
    def name(self) -> str:
        """Its word in tables."""
        return "exact"

    @property
    def order_matters(self) -> bool:
        """False."""
        return False

    def prior(self, network: Network, seed: int) -> Belief:
        """The belief without evidence."""
        return ExactBelief(network)


@dataclass(frozen=True)
class MessagePassing:
    """The paper's engine with some settings.

    Examples
    --------
    >>> MessagePassing(Settings.repaired()).name
    'repaired'
    """

    settings: Settings

    @property
    def name(self) -> str:
        """The preset's name; the settings where they are of none."""
        return next((name for name, preset in PRESETS.items() if preset == self.settings), repr(self.settings))

    @property
    def order_matters(self) -> bool:
        """True: each measurement passes old beliefs on again."""
        return True

    def prior(self, network: Network, seed: int) -> Belief:
        """The belief without evidence."""
        from palpate.inference.message_passing.belief import MessagePassingBelief

        return MessagePassingBelief(network, self.settings, seed)


def engine_words(name: str) -> str:
    """What people read in place of an engine's name in tables.

    Examples
    --------
    >>> engine_words("as-released"), engine_words("exact")
    ('ACTSEL as released', 'exact')
    """
    return f"ACTSEL {name.replace('-', ' ')}" if name in PRESETS else name
