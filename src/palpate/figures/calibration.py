"""The picture of a calibration: probabilities against frequencies, and ranks of the truth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.experiments.comparison.results import Results
from palpate.figures.palette import BLUE, GREY, INK, PALE, plain, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_calibration"]

BINS, RANK_BINS = 15, 20


def draw_calibration(results: Results, path: Path) -> None:
    """Draw reliability diagrams of categorical properties, all states pooled, and rank histograms of continuous ones.

    A point of a reliability diagram holds all beliefs whose probability of a state is in one of 15
    bins; its size goes with their number. Ranks of the truth are even where beliefs are calibrated;
    the band is where 99 % of the bars are then.
    """
    from matplotlib.figure import Figure

    columns = max(len(results.categorical), len(results.continuous), 1)
    figure = Figure(figsize=(2.75 * columns, 5.6), layout="constrained")
    grid = figure.subplots(2, columns, squeeze=False)
    for axes in grid.ravel():
        axes.set_visible(False)
    for axes, name in zip(grid[0], results.categorical, strict=False):
        _draw_states(axes, results, name)
    for axes, name in zip(grid[1], results.continuous, strict=False):
        _draw_ranks(axes, results, name)
    save(figure, path)


def _draw_states(axes: Axes, results: Results, name: str) -> None:
    axes.set_visible(True)
    p, truth, _ = results.stacked(name)
    hit = (truth[:, None] == np.arange(p.shape[1])).ravel()
    place = np.minimum((p.ravel() * BINS).astype(int), BINS - 1)
    count = np.bincount(place, minlength=BINS)
    held = count > 0
    mean = np.bincount(place, p.ravel(), BINS)[held] / count[held]
    frequency = np.bincount(place, hit, BINS)[held] / count[held]
    axes.plot([0, 1], [0, 1], color=PALE, lw=1.5, zorder=0)
    axes.scatter(mean, frequency, s=8 + 70 * np.sqrt(count[held] / count.max()), color=BLUE, alpha=0.8)
    plain(axes, name)
    axes.set_xlabel("probability of a state")
    axes.set_ylabel("how often it was true")


def _draw_ranks(axes: Axes, results: Results, name: str) -> None:
    axes.set_visible(True)
    rank = results.numbers(f"{name}_rank")
    rank = rank[~np.isnan(rank)]
    share = np.bincount(np.minimum((rank * RANK_BINS).astype(int), RANK_BINS - 1), minlength=RANK_BINS) / len(rank)
    even = 1 / RANK_BINS
    reach = 2.58 * np.sqrt(even * (1 - even) / len(rank))
    axes.axhspan(even - reach, even + reach, color=PALE, zorder=0)
    axes.bar((np.arange(RANK_BINS) + 0.5) / RANK_BINS, share, 0.9 / RANK_BINS, color=GREY)
    axes.axhline(even, color=INK, lw=0.8)
    plain(axes, name)
    axes.set_xlabel("probability below the truth")
    axes.set_ylabel("share of the objects")
