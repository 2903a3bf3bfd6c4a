"""Readings of a number beside the true values, as arrays: a reading, or a bound beyond which it was."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palpate.fitting.data import Specimen
from palpate.network.sensors import NumberOutcome, NumberSensor
from palpate.outcomes import Above, Below, Reading

__all__ = ["Readings", "readings_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Readings:
    """Readings (n,).

    Attributes
    ----------
    truth
        True values.
    value
        Readings, or bounds.
    side
        0 for a reading, 1 for above the bound, -1 for below.
    thing
        Which object each is of, as a place in `names`.
    """

    truth: Array
    value: Array
    side: Array
    thing: NDArray[np.intp]
    names: tuple[str, ...]

    @property
    def exact(self) -> NDArray[np.bool_]:
        """Which are readings and no bounds (n,)."""
        return np.asarray(self.side == 0)

    def only(self, kept: NDArray[np.bool_]) -> Readings:
        """Some of them."""
        parts = {name: getattr(self, name)[kept] for name in ("truth", "value", "side", "thing")}
        return replace(self, **parts)

    def log_likelihoods(self, sensor: NumberSensor, bias: float = 0.0) -> Array:
        """Natural log of the density of each, offsets of objects apart; of a bound, of the probability beyond it.

        Source: the censored likelihood of Tobin (1958).
        """
        scale = sensor.scale(self.truth)
        z = (self.value - bias - self.truth) / scale
        exact = self.exact
        found = np.empty(len(z))
        found[exact] = sensor.noise.log_density(z[exact]) - np.log(scale[exact])
        found[~exact] = sensor.noise.log_cdf(-self.side[~exact] * z[~exact])
        return found

    def by_thing(self, bias: float = 0.0) -> list[tuple[float, list[NumberOutcome]]]:
        """The true value of each object and its outcomes less the bias."""
        outcomes: dict[int, list[NumberOutcome]] = {}
        rows = zip(self.thing.tolist(), (self.value - bias).tolist(), self.side.tolist(), strict=True)
        for thing, value, side in rows:
            outcomes.setdefault(thing, []).append(_outcome(value, side))
        truth = dict(zip(self.thing.tolist(), self.truth.tolist(), strict=True))
        return [(truth[thing], found) for thing, found in outcomes.items()]


def _outcome(value: float, side: float) -> NumberOutcome:
    if side == 0:
        return Reading(value)
    return Above(value) if side > 0 else Below(value)


def readings_of(action: str, sensor: NumberSensor, specimens: Sequence[Specimen]) -> Readings:
    """The readings that an action gave on objects whose true value is known."""
    rows: list[tuple[float, float, float, int]] = []
    names: list[str] = []
    for one in specimens:
        outcomes = [o for o in one.readings.get(action, ()) if isinstance(o, Reading | Above | Below)]
        if outcomes and sensor.property in one.truth:
            truth = float(one.truth[sensor.property])
            rows += sorted((truth, *_row(outcome), len(names)) for outcome in outcomes)
            names.append(one.name)
    truth_, value, side, thing = np.array(rows, dtype=float).reshape(-1, 4).T
    return Readings(truth_, value, side, thing.astype(np.intp), tuple(names))


def _row(outcome: NumberOutcome) -> tuple[float, float]:
    if isinstance(outcome, Reading):
        return outcome.value, 0.0
    return outcome.bound, 1.0 if isinstance(outcome, Above) else -1.0
