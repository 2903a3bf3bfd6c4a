"""The purse of a plan: what its actions may cost together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf

__all__ = ["Purse"]

ROUNDING = 1e-9
"""A sum of costs that should meet a budget exactly may exceed it by this [s]."""


@dataclass(frozen=True)
class Purse:
    """What may still be spent.

    Parameters
    ----------
    left_s
        What the actions of a plan may cost together [s]; without limit unless given.
    costs_s
        Cost of every action [s].

    Examples
    --------
    >>> Purse(20.0, {"look": 1.0, "weigh": 15.0}).affords(["weigh", "look", "look"])
    True
    >>> Purse(20.0, {"look": 1.0, "weigh": 15.0}).affords(["weigh", "weigh"])
    False
    """

    left_s: float = inf
    costs_s: Mapping[str, float] = field(default_factory=dict)

    def affords(self, actions: Sequence[str]) -> bool:
        """Whether all of these actions can be paid."""
        return self.left_s == inf or sum(self.costs_s[name] for name in actions) <= self.left_s + ROUNDING
