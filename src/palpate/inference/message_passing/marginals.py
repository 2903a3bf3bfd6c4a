"""The marginal of a property for which an engine has no belief."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, nan

import numpy as np

from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.message_passing.grid import Grid

__all__ = ["UnsaidMarginal"]


@dataclass(frozen=True, eq=False, init=False)
class UnsaidMarginal(ContinuousMarginal):
    """Nothing is said: no nodes, figures that are no numbers, and an infinite SD.

    The SD is infinite so that no target for it is ever reached.

    Examples
    --------
    >>> marginal = UnsaidMarginal("mass", "g")
    >>> marginal.mean, marginal.sd, marginal.quantile(0.5), marginal.nodes.size
    (nan, inf, nan, 0)
    """

    def __init__(self, name: str, unit: str) -> None:
        super().__init__(name, unit, Grid(np.empty(0)), np.empty(0))

    @cached_property
    def mean(self) -> float:
        """No number."""
        return nan

    @cached_property
    def sd(self) -> float:
        """Infinite."""
        return inf

    @cached_property
    def entropy_bits(self) -> float:
        """No number."""
        return nan

    def cdf(self, x: float) -> float:
        """No number."""
        return nan

    def quantile(self, p: float) -> float:
        """No number."""
        return nan
