"""Case studies: one object and one objective, all its runs side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.experiments.frames import Frame
from palpate.figures.action_counts import stack_actions
from palpate.figures.palette import BLUE, GREY, INK, ORANGE, legend_above, plain, save, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_case_studies"]

MASS_SHOWN = 0.999
"""Share of a density that must be in view."""


def draw_case_studies(
    title: str,
    steps: Frame,
    beliefs: Frame,
    cases: Sequence[tuple[str, str, str]],
    colours: Mapping[str, str],
    path: Path,
) -> None:
    """Draw a row of panels per case, from the tables of one engine's chosen actions.

    From left to right: the expected gain of each action that is left, mean over the runs; what the
    action taken was expected to gain and what it did; which actions were taken, and when the runs
    stopped; the belief of each run after all actions.

    Parameters
    ----------
    title
        Whose choices and beliefs they are.
    cases
        Object, objective, and the property whose belief is shown.
    colours
        Action to its colour.
    path
        Where to write; its ending says what.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 0.9 + 3.0 * len(cases)), layout="constrained")
    grid = figure.subplots(len(cases), 4, squeeze=False)
    for row, case in zip(grid, cases, strict=True):
        _draw_case(row, steps, beliefs, case, colours)
    for axes in grid[-1, :3]:
        axes.set_xlabel("step")
    legend_above(figure, grid[0, 2], title)
    save(figure, path)


def _draw_case(
    row: Sequence[Axes], steps: Frame, beliefs: Frame, case: tuple[str, str, str], colours: Mapping[str, str]
) -> None:
    """Draw the four panels of a case."""
    thing, objective, shown = case
    own = steps.where(object=thing, objective=objective)
    last = max(own.unique("step"), default=0)
    _draw_expected(row[0], own, colours)
    _draw_gains(row[1], own)
    stack_actions(row[2], own, colours)
    whole(row[2].yaxis)
    _draw_final(row[3], beliefs.where(object=thing, objective=objective, step=last), own.unique(f"true_{shown}"))
    for axes in row[:3]:
        axes.set_xlim(0.4, last + 0.6)
    titles = (
        f"{thing}, learning {objective}",
        "gains of the action taken",
        "runs, with stopping",
        f"{shown} at the end",
    )
    for axes, words in zip(row, titles, strict=True):
        plain(axes, words)


def _draw_expected(axes: Axes, steps: Frame, colours: Mapping[str, str]) -> None:
    """Expected gain of each action at each decision, where it was left in some run."""
    for action, colour in colours.items():
        means = steps.means(f"gain_{action}_bits", "step")
        at = [step + 1 for step, bits in means.items() if not np.isnan(bits)]
        axes.plot(at, [means[step - 1] for step in at], "o-", color=colour, lw=1.6, ms=4)
    axes.axhline(0, color=GREY, lw=0.7)
    axes.set_ylabel("expected gain [bits]")
    whole(axes.xaxis)


def _draw_gains(axes: Axes, steps: Frame) -> None:
    """Expected and realised gain of the action taken: each run a dot, and the means."""
    taken = steps.rows(steps["step"] > 0)
    kinds = (
        ("expected_gain_bits", "expected", GREY, -0.2),
        ("realised_gain_bits", "realised", BLUE, 0.0),
        ("entropy_drop_bits", "fall of entropy", ORANGE, 0.2),
    )
    for column, words, colour, shift in kinds:
        values = taken[column].astype(float)
        axes.plot(taken["step"] + shift, values, "o", color=colour, ms=3, alpha=0.4, mew=0)
        means = taken.means(column, "step")
        axes.plot(
            [step + shift for step in means], list(means.values()), "_", color=colour, ms=11, mew=2.2, label=words
        )
    axes.axhline(0, color=GREY, lw=0.7)
    axes.set_ylabel("gain [bits]")
    whole(axes.xaxis)
    axes.legend(frameon=False, fontsize=7.5, loc="best")


def _draw_final(axes: Axes, beliefs: Frame, truths: Sequence[str | float]) -> None:
    """The belief of each run: bars of the mean and dots for states, a curve for a number."""
    if not beliefs.unique("state"):
        _draw_densities(axes, beliefs, truths)
        return
    means = beliefs.means("value", "state")
    places = {state: place for place, state in enumerate(means)}
    shades = [BLUE if state in truths else "#b9c9d6" for state in means]
    axes.barh(list(places.values()), list(means.values()), 0.7, color=shades)
    axes.plot(beliefs["value"], [places[state] for state in beliefs["state"]], "o", color=INK, ms=2.5, alpha=0.6, mew=0)
    axes.set_yticks(list(places.values()), list(places))
    axes.invert_yaxis()
    axes.set_xlim(0, 1)
    axes.set_xlabel("probability (true state dark)" if truths else "probability (true state not known)")


def _draw_densities(axes: Axes, beliefs: Frame, truths: Sequence[str | float]) -> None:
    ends = []
    for repetition in beliefs.unique("repetition"):
        own = beliefs.where(repetition=repetition)
        x, density = own["x"].astype(float), own["value"].astype(float)
        axes.plot(x, density, color=BLUE, lw=1.2, alpha=0.75)
        below = np.concatenate([[0.0], np.cumsum(np.diff(x) * (density[1:] + density[:-1]) / 2)])
        ends.append(np.interp([1 - MASS_SHOWN, MASS_SHOWN], below / below[-1], x))
    for truth in truths:
        axes.axvline(float(truth), color=ORANGE, lw=1.4, ls="--", label="true value")
        ends.append(np.array([float(truth), float(truth)]))
    low, high = min(end[0] for end in ends), max(end[1] for end in ends)
    axes.set_xlim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    axes.set_ylim(bottom=0)
    axes.set_ylabel("density")
    if truths:
        axes.legend(frameon=False, fontsize=7.5)
