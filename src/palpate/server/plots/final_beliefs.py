"""What explorations of an object ended up believing of a property: a row for each, against what is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

from palpate.errors import plural
from palpate.server.plots.drawing import number
from palpate.server.plots.levels import known_levels
from palpate.server.plots.plot import Level, Plot, Point, Row
from palpate.store.final_beliefs import FinalBelief
from palpate.store.rows import most_probable

__all__ = ["beliefs_plot"]

ROW = 38.0


@dataclass(frozen=True)
class _Ends:
    """A belief as a middle and its ends, and in words."""

    low: float
    middle: float
    high: float
    told: str


def beliefs_plot(
    property: str, found: Sequence[FinalBelief], truths: Sequence[tuple[float, str]], label: str | None
) -> Plot | None:
    """The final beliefs about one property; None where none of them says anything of it.

    Parameters
    ----------
    truths
        Values that are known, in the beliefs' unit, each with its source.
    label
        The label that is known; the plot is of its probability.
    """
    told = [(one, one.belief[property]) for one in found if property in one.belief]
    shares = [(one, _shares(plain)) for one, plain in told]
    if any(share for _, share in shares):
        wanted = label or most_probable(next(share for _, share in shares if share))
        ends = [(one, _probability(share, wanted)) for one, share in shares if share]
        known = "known to be true" if label else "the most probable at last"
        levels = (Level(1.0, "true: 1"),) if label else (Level(0.0), Level(1.0))
        return _rows(property, ends, f"probability of {wanted}, {known}", levels)
    units = {plain.get("unit") for _, plain in told if isinstance(plain.get("unit"), str)}
    of_numbers = [(one, _interval(plain)) for one, plain in told]
    ends = [(one, end) for one, end in of_numbers if end is not None]
    # beliefs of networks that do not agree about the unit cannot stand beside each other
    if not ends or len(units) != 1:
        return None
    return _rows(property, ends, f"{property} [{units.pop()}]", known_levels(truths))


def _rows(property: str, ends: Sequence[tuple[FinalBelief, _Ends]], across: str, levels: tuple[Level, ...]) -> Plot:
    rows, points = [], []
    for place, (one, end) in enumerate(ends):
        top = ROW * place
        rows.append(Row(f"{one.started_at:%Y-%m-%d %H:%M}", f"{one.actions} actions", top, top + ROW))
        points.append(Point(end.middle, top + ROW / 2, end.low, end.high, end.told, f"/episodes/{one.episode}"))
    return Plot(
        title=f"{property}: what {plural(len(ends), 'exploration')} believed at last",
        across=across,
        rows=tuple(rows),
        points=tuple(points),
        levels=levels,
    )


def _shares(plain: Mapping[str, Any]) -> dict[str, float]:
    shares = plain.get("probabilities")
    if not isinstance(shares, dict):
        return {}
    return {str(label): float(share) for label, share in shares.items() if _is_number(share)}


def _probability(shares: Mapping[str, float], label: str) -> _Ends:
    best, share = most_probable(shares), shares.get(label, 0.0)
    told = f"{label} {share:.1%}; the most probable is {best} with {shares[best]:.1%}"
    return _Ends(share, share, share, told)


def _interval(plain: Mapping[str, Any]) -> _Ends | None:
    """The median, or the mean where it is there, with the stretch that holds nine tenths."""
    quantiles = plain.get("quantiles")
    if not isinstance(quantiles, dict) or not all(_is_number(quantiles.get(key)) for key in ("0.05", "0.5", "0.95")):
        return None
    low, middle, high = (float(quantiles[key]) for key in ("0.05", "0.5", "0.95"))
    middle = float(plain["mean"]) if _is_number(plain.get("mean")) else middle
    return _Ends(low, middle, high, f"{number(middle)} {plain.get('unit', '')}, 90% in {number(low)} to {number(high)}")


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)
