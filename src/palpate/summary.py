"""A belief in short: enough of every property to print it, to draw it, and to keep it in a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from palpate.errors import LogError
from palpate.inference.belief import Belief
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.inference.message_passing.marginals import UnsaidMarginal

__all__ = [
    "BeliefSummary",
    "CategoricalSummary",
    "ContinuousSummary",
    "Summary",
    "UnsaidSummary",
    "summarise",
    "summary_from_json",
]

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
CURVE_POINTS = 120


@dataclass(frozen=True)
class CategoricalSummary:
    """Probabilities of the states of a property."""

    probabilities: Mapping[str, float]
    entropy_bits: float

    def to_json(self) -> dict[str, Any]:
        """Return what stands in a log."""
        return {"probabilities": dict(self.probabilities), "entropy_bits": self.entropy_bits}


@dataclass(frozen=True)
class ContinuousSummary:
    """Figures of a continuous property, in its unit, and its density as a thin curve.

    Parameters
    ----------
    sd
        None where there is none, as for a heavy tail.
    quantiles
        Probability, as text such as ``0.05``, to the value below which the property lies.
    x, density
        Points of the curve: values [unit] and density [1/unit].
    """

    unit: str
    mean: float | None
    sd: float | None
    entropy_bits: float | None
    quantiles: Mapping[str, float]
    x: tuple[float, ...]
    density: tuple[float, ...]

    def to_json(self) -> dict[str, Any]:
        """Return what stands in a log."""
        figures = {"unit": self.unit, "mean": self.mean, "sd": self.sd, "entropy_bits": self.entropy_bits}
        return {**figures, "quantiles": dict(self.quantiles), "x": list(self.x), "density": list(self.density)}


@dataclass(frozen=True)
class UnsaidSummary:
    """A number of which the engine has no belief: only its unit is known."""

    unit: str

    def to_json(self) -> dict[str, Any]:
        """Return what stands in a log: the fields of a number, empty."""
        figures = {"unit": self.unit, "mean": None, "sd": None, "entropy_bits": None}
        return {**figures, "quantiles": {}, "x": [], "density": []}


Summary = CategoricalSummary | ContinuousSummary | UnsaidSummary
BeliefSummary = Mapping[str, Summary]
"""Property to its summary, in the order of the network."""


def summarise(belief: Belief) -> BeliefSummary:
    """Summarise the belief about every property."""
    return {name: _summary(belief.marginal(name)) for name in belief.network.properties}


def summary_from_json(where: str, found: Mapping[str, Any]) -> BeliefSummary:
    """Read what `to_json` wrote, property by property; LogError names what is missing."""
    return {name: _from_json(f"{where}: belief about {name!r}", entry) for name, entry in found.items()}


def _summary(marginal: CategoricalMarginal | ContinuousMarginal) -> Summary:
    if isinstance(marginal, UnsaidMarginal):
        return UnsaidSummary(marginal.unit)
    if isinstance(marginal, CategoricalMarginal):
        states = zip(marginal.states, marginal.probabilities.tolist(), strict=True)
        return CategoricalSummary(dict(states), marginal.entropy_bits)
    x, density = _curve(marginal)
    return ContinuousSummary(
        unit=marginal.unit,
        mean=marginal.mean,
        sd=marginal.sd,
        entropy_bits=marginal.entropy_bits,
        quantiles={f"{p:g}": marginal.quantile(p) for p in QUANTILES},
        x=x,
        density=density,
    )


def _curve(marginal: ContinuousMarginal) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Thin the density: points where the mass is, and points in between for long flat stretches."""
    nodes, density = marginal.curve
    # The trapezoid rule places points of equal mass well enough for a drawing, and at once.
    below = np.concatenate([[0.0], np.cumsum(np.diff(nodes) * (density[1:] + density[:-1]) / 2)])
    where_mass = np.interp(np.linspace(0.0005, 0.9995, CURVE_POINTS // 2) * below[-1], below, nodes)
    x = np.unique(np.concatenate([where_mass, np.linspace(where_mass[0], where_mass[-1], CURVE_POINTS // 2)]))
    return tuple(map(_rounded, x)), tuple(map(_rounded, np.interp(x, nodes, density)))


def _rounded(value: float) -> float:
    """Round to the six digits a drawing can show."""
    return float(f"{value:.6g}")


def _from_json(where: str, entry: Mapping[str, Any]) -> Summary:
    try:
        if "probabilities" in entry:
            return CategoricalSummary(entry["probabilities"], entry["entropy_bits"])
        if not entry["x"]:
            return UnsaidSummary(entry["unit"])
        return ContinuousSummary(
            unit=entry["unit"],
            mean=entry["mean"],
            sd=entry["sd"],
            entropy_bits=entry["entropy_bits"],
            quantiles=entry["quantiles"],
            x=tuple(entry["x"]),
            density=tuple(entry["density"]),
        )
    except (KeyError, TypeError) as error:
        raise LogError(f"{where} is incomplete: {error}") from error
