"""Objectives: what an exploration wants to learn, as information in bits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from palpate.errors import EvidenceError
from palpate.information import entropy_bits
from palpate.network.properties import CategoricalProperty

if TYPE_CHECKING:
    from palpate.inference.belief import Belief

__all__ = ["Everything", "Learn", "Objective", "Weighted"]


class Objective(Protocol):
    """Something to learn about an object."""

    @property
    def name(self) -> str:
        """What people read, such as ``material``."""

    @property
    def properties(self) -> tuple[str, ...]:
        """The properties it is about; empty for all of them."""

    def gains(self, belief: Belief, actions: Iterable[str]) -> dict[str, float]:
        """Expected information gain of each action [bits].

        Raises
        ------
        EvidenceError
            An unknown property or action, or a gain that the belief's engine cannot give.
        """

    def realised(self, before: Belief, after: Belief) -> float | None:
        """Gain of the one observation between two beliefs [bits]; None where an engine has none."""

    def entropy_drop(self, before: Belief, after: Belief) -> float | None:
        """Fall of the entropy between two beliefs [bits]; None unless all is categorical."""


@dataclass(frozen=True)
class _Information:
    """Information on whatever an engine calls `key`."""

    key: str | tuple[str, ...] = field(repr=False)

    def gains(self, belief: Belief, actions: Iterable[str]) -> dict[str, float]:
        """Expected information gain of each action [bits]."""
        table = belief.expected_gains([self.key], list(actions))
        return {action: self._known(action, row[self.key]) for action, row in table.items()}

    def _known(self, action: str, gain: float | None) -> float:
        if gain is None:
            found = self.key if isinstance(self.key, str) else ", ".join(self.key)
            raise EvidenceError(
                f"the engine cannot say what action {action!r} tells about {found!r}: "
                "choose another objective or another engine"
            )
        return gain

    def realised(self, before: Belief, after: Belief) -> float | None:
        """Gain of the one observation between two beliefs [bits]."""
        return before.realised_gain(after, self.key)


@dataclass(frozen=True, init=False)
class Learn(_Information):
    """Joint information on one property or on several together.

    Examples
    --------
    >>> Learn("category", "material").name
    'category, material'
    """

    properties: tuple[str, ...]

    def __init__(self, *properties: str) -> None:
        if not properties:
            raise EvidenceError("Learn names no property, expected at least one")
        once = tuple(dict.fromkeys(properties))
        object.__setattr__(self, "properties", once)
        object.__setattr__(self, "key", once[0] if len(once) == 1 else once)

    @property
    def name(self) -> str:
        """The properties' names."""
        return ", ".join(self.properties)

    def entropy_drop(self, before: Belief, after: Belief) -> float | None:
        """Fall of the joint entropy [bits]; None unless all properties are categorical."""
        if not all(isinstance(before.network.property(name), CategoricalProperty) for name in self.properties):
            return None
        fall = entropy_bits(before.probabilities(*self.properties)) - entropy_bits(
            after.probabilities(*self.properties)
        )
        return float(fall)


@dataclass(frozen=True)
class Everything(_Information):
    """Joint information on all properties of the network."""

    key: str | tuple[str, ...] = field(default="everything", init=False, repr=False)

    @property
    def name(self) -> str:
        """The word for it in tables and on the command line."""
        return "everything"

    @property
    def properties(self) -> tuple[str, ...]:
        """Empty: all of them."""
        return ()

    def entropy_drop(self, before: Belief, after: Belief) -> float | None:
        """None unless the whole network is categorical."""
        names = tuple(before.network.properties)
        return Learn(*names).entropy_drop(before, after)


@dataclass(frozen=True)
class Weighted:
    """A sum of objectives, each times its weight.

    Examples
    --------
    >>> Weighted({Learn("material"): 1.0, Learn("mass"): 0.5}).name
    '1 x material + 0.5 x mass'
    """

    parts: Mapping[Objective, float]

    def __post_init__(self) -> None:
        """Refuse weights of which no sensible sum can be made."""
        for part, weight in self.parts.items():
            if not 0 < weight < float("inf"):
                raise EvidenceError(f"the weight of {part.name!r} is {weight!r}, expected a number above zero")
        if not self.parts:
            raise EvidenceError("Weighted holds no objective, expected at least one")

    @property
    def name(self) -> str:
        """Weights and names."""
        return " + ".join(f"{weight:g} x {part.name}" for part, weight in self.parts.items())

    @property
    def properties(self) -> tuple[str, ...]:
        """The properties of all parts; empty, for all, if one part is about all."""
        if not all(part.properties for part in self.parts):
            return ()
        return tuple(dict.fromkeys(name for part in self.parts for name in part.properties))

    def gains(self, belief: Belief, actions: Iterable[str]) -> dict[str, float]:
        """Weighted sum of the parts' expected gains of each action [bits]."""
        names = list(actions)
        rows = [(weight, part.gains(belief, names)) for part, weight in self.parts.items()]
        return {name: sum(weight * gains[name] for weight, gains in rows) for name in names}

    def realised(self, before: Belief, after: Belief) -> float | None:
        """Weighted sum of the parts' realised gains [bits]; None where one has none."""
        return self._sum((weight, part.realised(before, after)) for part, weight in self.parts.items())

    def entropy_drop(self, before: Belief, after: Belief) -> float | None:
        """Weighted sum of the parts' falls of entropy [bits]; None where one has none."""
        return self._sum((weight, part.entropy_drop(before, after)) for part, weight in self.parts.items())

    @staticmethod
    def _sum(terms: Iterable[tuple[float, float | None]]) -> float | None:
        total = 0.0
        for weight, term in terms:
            if term is None:
                return None
            total += weight * term
        return total
