"""A belief before and after a step: bars for states, densities for numbers."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup

from palpate.server.plots.drawing import Drawing, number, with_sd
from palpate.server.plots.scale import Scale, spanning
from palpate.summary import BeliefSummary, CategoricalSummary, ContinuousSummary

__all__ = ["BeliefRow", "belief_rows"]

WIDTH, LEFT, RIGHT = 520.0, 120.0, 60.0
BAR, TOP, BOTTOM = 20.0, 6.0, 44.0
HEIGHT = 120.0
MOST_STATES = 12


@dataclass(frozen=True)
class BeliefRow:
    """One property: a picture, and its figures before and after in words."""

    name: str
    plot: Markup
    before: str
    after: str


def belief_rows(before: BeliefSummary, after: BeliefSummary) -> list[BeliefRow]:
    """Each property of a belief; those of which nothing is said are left out."""
    rows = []
    for name, now in after.items():
        then = before.get(name)
        if isinstance(now, CategoricalSummary) and isinstance(then, CategoricalSummary):
            words = [_best(one) for one in (then, now)]
            rows.append(BeliefRow(name, _bars(name, then, now), *words))
        elif isinstance(now, ContinuousSummary) and isinstance(then, ContinuousSummary):
            words = [_figures(one) for one in (then, now)]
            rows.append(BeliefRow(name, _densities(name, then, now), *words))
    return rows


def _best(summary: CategoricalSummary) -> str:
    label, share = max(summary.probabilities.items(), key=lambda item: item[1])
    return f"{label} {share:.0%}, {summary.entropy_bits:.2f} bits"


def _figures(summary: ContinuousSummary) -> str:
    if summary.mean is None:
        return f"median {number(summary.quantiles['0.5'])} {summary.unit}"
    return f"{with_sd(summary.mean, summary.sd)} {summary.unit}"


def _bars(name: str, before: CategoricalSummary, after: CategoricalSummary) -> Markup:
    states = sorted(after.probabilities, key=lambda state: -after.probabilities[state])[:MOST_STATES]
    drawing = Drawing(WIDTH, TOP + BAR * len(states) + 4, f"{name}: {_best(before)} before, {_best(after)} after")
    across = Scale(0.0, 1.0, LEFT, WIDTH - RIGHT)
    for place, state in enumerate(states):
        y, share, then = TOP + place * BAR, after.probabilities[state], before.probabilities.get(state, 0.0)
        drawing.text(LEFT - 8, y + 14, state, "name", "end")
        drawing.rectangle(LEFT, y + 3, across.at(share) - LEFT, BAR - 7, "after")
        drawing.line(across.at(then), y + 1, across.at(then), y + BAR - 2, "before")
        drawing.text(across.at(max(share, then)) + 6, y + 14, f"{share:.1%}", "tick")
    return drawing.markup()


def _densities(name: str, before: ContinuousSummary, after: ContinuousSummary) -> Markup:
    told = f"{name} [{after.unit}]: {_figures(before)} before, {_figures(after)} after"
    drawing = Drawing(WIDTH, TOP + HEIGHT + BOTTOM, told)
    across = spanning([*_middle(before), *_middle(after)], LEFT - 80, WIDTH - RIGHT)
    most = max([*before.density, *after.density, 1e-300])
    up = Scale(0.0, most * 1.05, TOP + HEIGHT, TOP)
    drawing.across_axis(across, TOP, TOP + HEIGHT, f"{name} [{after.unit}]")
    for summary, kind in ((after, "after-line"), (before, "before")):
        inside = [(x, y) for x, y in zip(summary.x, summary.density, strict=True) if across.low <= x <= across.high]
        line = [(across.at(x), up.at(y)) for x, y in inside]
        if summary is after and line:
            drawing.area([(line[0][0], up.at(0.0)), *line, (line[-1][0], up.at(0.0))], "after-area")
        drawing.curve(line, kind)
    return drawing.markup()


def _middle(summary: ContinuousSummary) -> tuple[float, float]:
    """The stretch that matters: long tails would press all else together."""
    low, high = summary.quantiles["0.05"], summary.quantiles["0.95"]
    return low - (high - low) / 4, high + (high - low) / 4
