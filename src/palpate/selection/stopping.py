"""Stopping rules: when an exploration has learnt enough, or has spent enough.

Rules compose: ``GainBelow(0.05) | CostBudget(60)`` stops as soon as one of the two says so.
As an expected gain is never negative, "no gain is left" would never hold: the default is
``GainBelow(0.05)``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Protocol

from palpate.errors import EvidenceError
from palpate.network.properties import CategoricalProperty

if TYPE_CHECKING:
    from palpate.inference.belief import Belief

__all__ = [
    "AnyOf",
    "CostBudget",
    "EntropyBelow",
    "GainBelow",
    "NetGainBelow",
    "NothingLeft",
    "SdBelow",
    "Situation",
    "StepBudget",
    "StoppingRule",
]


@dataclass(frozen=True, eq=False)
class Situation:
    """All that a stopping rule may look at.

    Parameters
    ----------
    gains
        Expected gain for the objective [bits] of each action that can be taken now.
    costs_s
        Cost of every action of the repertoire [s].
    taken
        The actions taken so far, in order.
    too_dear
        Actions that are left but would exceed the cost budget.
    """

    belief: Belief
    gains: Mapping[str, float]
    costs_s: Mapping[str, float]
    spent_s: float = 0.0
    taken: Sequence[str] = ()
    too_dear: Sequence[str] = field(default=())


class StoppingRule(Protocol):
    """Says when to stop; inherit from it to have ``|`` and no budget."""

    @property
    def budget_s(self) -> float:
        """The cost that may not be exceeded [s]; an action that would is not chosen."""
        return inf

    @property
    def most_steps(self) -> float:
        """The number of steps that may not be exceeded."""
        return inf

    def reason(self, situation: Situation) -> str | None:
        """Why to stop, for people to read; None to go on."""

    def __or__(self, other: StoppingRule) -> AnyOf:
        """Stop when this rule or the other one says so."""
        return AnyOf((*_rules(self), *_rules(other)))


def _rules(rule: StoppingRule) -> tuple[StoppingRule, ...]:
    return rule.rules if isinstance(rule, AnyOf) else (rule,)


@dataclass(frozen=True)
class AnyOf(StoppingRule):
    """Stops when one of its rules does, with the reason of the first one that does."""

    rules: tuple[StoppingRule, ...]

    @property
    def budget_s(self) -> float:
        """The smallest budget of the rules [s]."""
        return min((rule.budget_s for rule in self.rules), default=inf)

    @property
    def most_steps(self) -> float:
        """The smallest number of steps that one of the rules allows."""
        return min((rule.most_steps for rule in self.rules), default=inf)

    def reason(self, situation: Situation) -> str | None:
        """Why the first rule that stops does."""
        return next((reason for rule in self.rules if (reason := rule.reason(situation))), None)


@dataclass(frozen=True)
class GainBelow(StoppingRule):
    """Stops when the best expected gain is below a threshold."""

    bits: float = 0.05

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on."""
        best = max(situation.gains.values(), default=inf)
        return f"best expected gain {best:.3g} bits is below {self.bits:g} bits" if best < self.bits else None


@dataclass(frozen=True)
class NetGainBelow(StoppingRule):
    """Stops when no action is worth its cost: no gain - price x cost is above zero.

    `GreedyPerCost` fits it: it takes an action that is worth its cost as long as there is one.
    """

    price_bits_per_s: float

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on."""
        price = self.price_bits_per_s
        net = max((gain - price * situation.costs_s[a] for a, gain in situation.gains.items()), default=inf)
        return f"no action is worth its cost at {price:g} bits/s (best net gain {net:.3g} bits)" if net <= 0 else None


@dataclass(frozen=True)
class EntropyBelow(StoppingRule):
    """Stops when the entropy of a categorical property has come down to a target."""

    property: str
    bits: float

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on.

        Raises
        ------
        EvidenceError
            If the property is not categorical.
        """
        if not isinstance(situation.belief.network.property(self.property), CategoricalProperty):
            raise EvidenceError(f"an entropy target needs a categorical property, {self.property!r} has an SD target")
        entropy = situation.belief.marginal(self.property).entropy_bits
        if entropy is None or entropy > self.bits:
            return None
        return f"entropy of {self.property} {entropy:.3g} bits has reached {self.bits:g} bits"


@dataclass(frozen=True)
class SdBelow(StoppingRule):
    """Stops when the SD of a continuous property, in its unit, has come down to a target."""

    property: str
    sd: float

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on.

        Raises
        ------
        EvidenceError
            If the property is not continuous, or the belief has no SD of it.
        """
        measured = situation.belief.network.property(self.property)
        marginal = situation.belief.marginal(self.property)
        if isinstance(measured, CategoricalProperty) or not hasattr(marginal, "sd"):
            raise EvidenceError(f"an SD target needs a continuous property, {self.property!r} has an entropy target")
        if marginal.sd > self.sd:
            return None
        return f"SD of {self.property} {marginal.sd:.3g} {measured.unit} has reached {self.sd:g} {measured.unit}"


@dataclass(frozen=True)
class CostBudget(StoppingRule):
    """Stops when nothing that is left fits into the budget."""

    seconds: float

    @property
    def budget_s(self) -> float:
        """The budget [s]."""
        return self.seconds

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on."""
        if situation.gains or not situation.too_dear:
            return None
        cheapest = min(situation.costs_s[action] for action in situation.too_dear)
        spent = f"{situation.spent_s:g} s of {self.seconds:g} s are spent"
        return f"the cost budget is used up: {spent} and the cheapest action left costs {cheapest:g} s"


@dataclass(frozen=True)
class StepBudget(StoppingRule):
    """Stops after a number of steps, failed ones included."""

    steps: int

    @property
    def most_steps(self) -> float:
        """The number of steps."""
        return self.steps

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on."""
        done = len(situation.taken)
        return f"the budget of {self.steps} steps is used up" if done >= self.steps else None


@dataclass(frozen=True)
class NothingLeft(StoppingRule):
    """Stops only when no action is left, as every exploration does."""

    def reason(self, situation: Situation) -> str | None:
        """Why to stop; None to go on."""
        return None if situation.gains or situation.too_dear else "no action is left"
