"""The figure of the known objects on the bench, drawn from the table of results alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.experiments.bench.held_out import CALIBRATED, GREEDY, PUBLISHED
from palpate.experiments.bench.pairs import PAIRS
from palpate.experiments.comparison.methods import RANDOM
from palpate.experiments.comparison.results import Results
from palpate.figures.palette import BLUE, GREY, ORANGE, PALE, plain, save, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_bench"]

CURVES = (
    (CALIBRATED, GREEDY.name, "greedy, calibrated sensors", BLUE, "o-"),
    (CALIBRATED, RANDOM.name, "random, calibrated sensors", GREY, "o-"),
    (PUBLISHED, GREEDY.name, "greedy, published sensors", ORANGE, "s--"),
)
LEAST, MARKED = 1e-4, 0.01
"""Surprise numbers are drawn down to this one; those below the second are marked when an object is explored."""
COLOURS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7")


def draw_bench(results: Results, path: Path) -> None:
    """Draw what is learned by number of actions, and what was surprising about look-alikes.

    Parameters
    ----------
    path
        Where to write; its ending says what.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 4.4), layout="constrained")
    learned, told = figure.subplots(1, 2)
    _draw_learning(learned, results)
    _draw_pairs(told, results.where(world=PAIRS))
    save(figure, path)


def _draw_learning(axes: Axes, results: Results) -> None:
    for world, method, words, colour, style in CURVES:
        curve = results.where(world=world, method=method).curve("cross_entropy_bits")
        axes.plot(curve.steps, curve.mean, style, color=colour, lw=1.8, ms=4, label=words)
        axes.fill_between(curve.steps, curve.low, curve.high, color=colour, alpha=0.12, lw=0)
    plain(axes, "What is learned, with 95 % intervals over objects")
    axes.set_xlabel("actions taken")
    axes.set_ylabel("cross-entropy of the truth [bits]\nmean of the categorical properties")
    axes.set_ylim(bottom=0)
    whole(axes.xaxis)
    axes.legend(frameon=False, fontsize=8)


def _draw_pairs(axes: Axes, own: Results) -> None:
    """A row for each object, a dot for each action and repetition."""
    things, actions = own.distinct("object"), own.distinct("used")
    for number, (action, colour) in enumerate(zip(actions, COLOURS, strict=False)):
        part = own.where(used=action)
        rows = np.array([things.index(name) for name in part.texts("object")])
        lift = 0.15 * (number - (len(actions) - 1) / 2)
        surprise = np.maximum(part.numbers("surprise"), LEAST)
        axes.plot(surprise, rows + lift, "o", color=colour, ms=4, alpha=0.7, markeredgewidth=0, label=action)
    axes.axvline(MARKED, color=PALE, lw=1.5, zorder=0)
    axes.set_xscale("log")
    axes.set_xlim(LEAST * 0.8, 1.25)
    axes.set_yticks(range(len(things)), list(things))
    axes.invert_yaxis()
    plain(axes, "Pairs that look alike: what was surprising")
    axes.set_xlabel("probability of an outcome at least as unlikely, by action and repetition")
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.4, -0.14), ncols=5)
