"""Which actions were taken at each step, counted over runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.experiments.frames import Frame
from palpate.figures.palette import INK, PALE, legend_above, plain, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_action_counts", "stack_actions"]


def draw_action_counts(
    engines: Mapping[str, Frame], objectives: Sequence[str], colours: Mapping[str, str], path: Path
) -> None:
    """Draw a panel per engine and objective: stacked counts of the actions of each step, with stopping.

    Parameters
    ----------
    engines
        What stands above a row of panels, to the steps of that engine's chosen actions.
    colours
        Action to its colour.
    path
        Where to write; its ending says what.
    """
    from matplotlib.figure import Figure

    rows, columns = len(engines), len(objectives)
    figure = Figure(figsize=(1.0 + 2.7 * columns, 0.7 + 2.4 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for row, (name, steps) in zip(grid, engines.items(), strict=True):
        for axes, objective in zip(row, objectives, strict=True):
            stack_actions(axes, steps.where(objective=objective), colours)
            plain(axes, f"{objective}: {name}")
        row[0].set_ylabel("runs")
    for axes in grid[-1]:
        axes.set_xlabel("step")
    legend_above(figure, grid[0, 0])
    save(figure, path)


def stack_actions(axes: Axes, steps: Frame, colours: Mapping[str, str]) -> None:
    """Stack the counts of each step's actions, those of runs that had stopped on top."""
    order = [step for step in sorted(steps.unique("step")) if step > 0]
    base = np.zeros(len(order))
    going = steps.where(stopped=False)
    for action, colour in colours.items():
        counts = np.array([len(going.where(step=step, action=action)) for step in order])
        axes.bar(order, counts, 0.8, base, color=colour, label=action, edgecolor="white", linewidth=0.5)
        base = base + counts
    ended = np.array([len(steps.where(step=step, stopped=True)) for step in order])
    axes.bar(order, ended, 0.8, base, color=PALE, label="stopped before", edgecolor="white", linewidth=0.5)
    axes.set_xticks(order)
    axes.tick_params(labelcolor=INK)
