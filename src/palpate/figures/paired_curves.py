"""Mean curves over the steps of chosen and of random actions, with their spread."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.experiments.frames import Frame
from palpate.figures.palette import BLUE, ORANGE, legend_above, plain, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Quantity", "draw_curves"]


@dataclass(frozen=True)
class Quantity:
    """A row of panels: an objective and a column of the table of steps about it."""

    objective: str
    column: str
    label: str


def draw_curves(
    engines: Mapping[str, Frame], quantities: Sequence[Quantity], arms: Mapping[str, str], path: Path
) -> None:
    """Draw a panel per quantity and engine: mean and quartiles over all runs, by step.

    Parameters
    ----------
    engines
        What stands above a column of panels, to the steps of that engine.
    arms
        Two names of arms in the table to what stands in the legend.
    path
        Where to write; its ending says what.
    """
    from matplotlib.figure import Figure

    rows, columns = len(quantities), len(engines)
    figure = Figure(figsize=(1.2 + 3.6 * columns, 0.7 + 2.7 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, sharey="row", squeeze=False)
    for row, quantity in zip(grid, quantities, strict=True):
        for axes, (name, steps) in zip(row, engines.items(), strict=True):
            for (arm, words), colour in zip(arms.items(), (BLUE, ORANGE), strict=True):
                _draw_curve(axes, steps.where(objective=quantity.objective, arm=arm), quantity.column, words, colour)
            plain(axes, f"{quantity.objective}: {name}")
            axes.set_ylim(bottom=0)
        row[0].set_ylabel(quantity.label)
    for axes in grid[-1]:
        axes.set_xlabel("actions taken")
    legend_above(figure, grid[0, 0])
    save(figure, path)


def _draw_curve(axes: Axes, steps: Frame, column: str, words: str, colour: str) -> None:
    values, order = steps[column].astype(float), sorted(steps.unique("step"))
    own = [values[(steps["step"] == step) & ~np.isnan(values)] for step in order]
    axes.plot(order, [v.mean() if v.size else np.nan for v in own], "o-", color=colour, lw=1.8, ms=4, label=words)
    low, high = ([np.quantile(v, share) if v.size else np.nan for v in own] for share in (0.25, 0.75))
    axes.fill_between(order, low, high, color=colour, alpha=0.15, lw=0, label=f"{words}, quartiles")
    axes.set_xticks(order)
