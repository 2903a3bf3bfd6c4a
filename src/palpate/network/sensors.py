"""Sensor models p(outcome | property); the same one serves the update and the expected gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import special

from palpate.network.noises import Kernel, Noise, NormalNoise, offset_nodes
from palpate.outcomes import Above, Below, Reading

__all__ = ["ConfusionSensor", "NumberOutcome", "NumberSensor", "Sensor"]

Array = NDArray[np.float64]
CHUNK = 1000
"""True values at which an offset is integrated over at a time."""
NumberOutcome = Reading | Above | Below
"""The outcomes of a number sensor that say something of the property."""


@dataclass(frozen=True, eq=False)
class ConfusionSensor:
    """A sensor of a categorical property that returns a label.

    Parameters
    ----------
    table
        P(outcome | state), outcomes x states; columns sum to one.
    repeat_probability
        Each look at one object repeats, with this probability, one hidden label drawn once from
        the object's column, and otherwise draws afresh: ten looks by one camera are not ten
        independent ones. 0 makes looks independent given the state.
    """

    property: str
    outcomes: tuple[str, ...]
    table: Array
    repeat_probability: float = 0.0

    @cached_property
    def by_state(self) -> Array:
        """P(outcome | state), states x outcomes; rows sum to one."""
        return np.ascontiguousarray(self.table.T)

    def _hidden(self, labels: Sequence[str]) -> Array:
        """P(hidden label, labels | state), hidden labels x states."""
        joint = self.table.copy()
        for label in labels:
            index = self.outcomes.index(label)
            fresh = (1 - self.repeat_probability) * self.table[index]
            joint *= fresh + self.repeat_probability * (np.arange(len(self.outcomes)) == index)[:, None]
        return joint

    def likelihood(self, labels: Sequence[str]) -> Array:
        """P(labels | state) of all looks at one object together [state]."""
        if not self.repeat_probability:
            return np.asarray(self.table[[self.outcomes.index(label) for label in labels]].prod(axis=0))
        return np.asarray(self._hidden(labels).sum(axis=0))

    def predictive(self, labels: Sequence[str]) -> Array:
        """P(next label | state, the labels so far), outcomes x states; columns sum to one."""
        if not self.repeat_probability or not labels:
            return self.table
        hidden = self._hidden(labels)
        total = hidden.sum(axis=0)
        hidden = np.where(total > 0, hidden / np.where(total > 0, total, 1), self.table)
        return self.repeat_probability * hidden + (1 - self.repeat_probability) * self.table


@dataclass(frozen=True, eq=False)
class NumberSensor:
    """A sensor of a continuous or derived property that returns a number in its unit.

    Parameters
    ----------
    sd
        Scale of the noise, in the property's unit.
    relative_sd
        Scale of the noise as a fraction of the true value; the two add in quadrature.
    low, high
        Readings below `low` and above `high` saturate: they are returned as `Below(low)` and
        `Above(high)` (a Tobit likelihood with an atom at each finite end).
    offset_sd
        SD of an offset common to all readings of one object, N(0, offset_sd^2).
    bias
        By how much readings are too high on average, in the property's unit.
    """

    property: str
    sd: float
    relative_sd: float = 0.0
    noise: Noise = field(default_factory=NormalNoise)
    low: float = -np.inf
    high: float = np.inf
    offset_sd: float = 0.0
    bias: float = 0.0

    def scale(self, x: Array, sd: float | None = None) -> Array:
        """Scale of the noise at true values x; `sd` is an outcome's own."""
        if sd is not None:
            return np.full_like(x, sd)
        if not self.relative_sd:
            return np.full_like(x, self.sd)
        # A purely relative noise would vanish at zero; 1e-12 keeps the density finite there.
        return np.maximum(np.hypot(self.sd, self.relative_sd * x), 1e-12)

    def _log_term(self, outcome: NumberOutcome, x: Array, centre: Array) -> Array:
        scale = self.scale(x, outcome.sd)
        if scale.ndim < centre.ndim:
            scale = scale[:, None]
        if isinstance(outcome, Reading):
            return self.noise.log_density((outcome.value - centre) / scale) - np.log(scale)
        sign = 1.0 if isinstance(outcome, Above) else -1.0
        return self.noise.log_cdf(sign * (centre - outcome.bound) / scale)

    def _offset(self, outcomes: Sequence[NumberOutcome], x: Array) -> tuple[Array, Array, Array]:
        """Posterior of the shared offset given x: (log evidence (X,), offsets (X, O), weights (X, O))."""
        least = min([*(float(self.scale(x, o.sd).min()) for o in outcomes), float(self.scale(x).min())])
        nodes, weight = offset_nodes(self.offset_sd, least)
        offsets, log_weight = nodes[None, :], np.broadcast_to(np.log(weight), (x.size, nodes.size))
        for outcome in outcomes:
            log_weight = log_weight + self._log_term(outcome, x, (x + self.bias)[:, None] + offsets)
        total = special.logsumexp(log_weight, axis=1)
        safe = np.where(np.isfinite(total), total, 0.0)
        return total, np.broadcast_to(offsets, log_weight.shape), np.exp(log_weight - safe[:, None])

    def _closed(self, outcomes: Sequence[NumberOutcome]) -> bool:
        return isinstance(self.noise, NormalNoise) and all(isinstance(o, Reading) for o in outcomes)

    def _pooled(self, outcomes: Sequence[NumberOutcome], x: Array) -> tuple[Array, Array]:
        """Precision-weighted mean of the readings and its variance without the offset, (X,) each."""
        precision = np.array([self.scale(x, o.sd) ** -2.0 for o in outcomes])  # (n, X)
        values = np.array([[o.value] for o in outcomes if isinstance(o, Reading)])
        variance = 1 / precision.sum(axis=0)
        return (precision * values).sum(axis=0) * variance, variance

    def log_likelihood(self, outcomes: Sequence[NumberOutcome], x: Array) -> Array:
        """Natural log of p(outcomes | x) of all readings of one object together (X,).

        Densities are per unit of the property for readings; bounds count as probabilities.
        """
        if not outcomes:
            return np.zeros_like(x)
        if not self.offset_sd:
            first, *more = (self._log_term(o, x, x + self.bias) for o in outcomes)
            return np.asarray(sum(more, first))
        if not self._closed(outcomes):
            parts = [x[start : start + CHUNK] for start in range(0, len(x), CHUNK)]
            return np.concatenate([self._offset(outcomes, part)[0] for part in parts])
        # Given the pooled mean the readings do not depend on x + offset: swap its variance.
        mean, variance = self._pooled(outcomes, x)
        middle = x + self.bias
        first, *more = (self._log_term(o, x, middle) for o in outcomes)
        independent = sum(more, first)
        wide = variance + self.offset_sd**2
        swap = 0.5 * (mean - middle) ** 2 * (1 / variance - 1 / wide) + 0.5 * np.log(variance / wide)
        return np.asarray(independent + swap)

    def predictive(self, outcomes: Sequence[NumberOutcome], x: Array, sd: float | None = None) -> Kernel:
        """The next reading's distribution given x and the readings so far."""
        scale, middle = self.scale(x, sd), x + self.bias
        if not self.offset_sd:
            return Kernel(self.noise, middle[:, None], scale[:, None], np.ones((x.size, 1)))
        if not self._closed(outcomes):
            _, offsets, weights = self._offset(outcomes, x)
            centre = middle[:, None] + offsets
            return Kernel(self.noise, centre, np.broadcast_to(scale[:, None], centre.shape), weights)
        variance_offset, shift = np.full_like(x, self.offset_sd**2), np.zeros_like(x)
        if outcomes:
            mean, variance = self._pooled(outcomes, x)
            share = variance_offset / (variance_offset + variance)
            variance_offset, shift = variance_offset * (1 - share), share * (mean - middle)
        total = np.sqrt(scale**2 + variance_offset)
        return Kernel(self.noise, (middle + shift)[:, None], total[:, None], np.ones((x.size, 1)))


Sensor = ConfusionSensor | NumberSensor
