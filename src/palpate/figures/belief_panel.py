"""A belief and what is being done about it, as pixels: one side of a video."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate.figures.episode import draw_belief
from palpate.figures.palette import BLUE, GREY, INK, PALE
from palpate.summary import BeliefSummary

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Panel", "draw_panel"]

COLUMNS, DPI = 2, 100


@dataclass(frozen=True)
class Panel:
    """What a panel shows.

    Attributes
    ----------
    title, words
        What is explored; what is being done, or what came of it.
    actions
        All that can be done.
    before, after
        The belief at the start, and now; as at the start where it is None.
    gains_bits
        Expected gain of each action that could be taken when the last choice was made.
    chosen
        The action chosen; none in the beginning.
    """

    title: str
    words: str
    actions: Sequence[str]
    before: BeliefSummary
    after: BeliefSummary | None = None
    gains_bits: Mapping[str, float] = field(default_factory=dict)
    chosen: str | None = None


def draw_panel(panel: Panel, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Draw a panel of so many pixels: width and height; (height, width, 3)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    width, height = size
    after = panel.after or panel.before
    rows = -(-len(after) // COLUMNS)
    spaced = ConstrainedLayoutEngine(h_pad=0.06, w_pad=0.1)
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, layout=spaced)
    canvas: Any = FigureCanvasAgg(figure)
    figure.suptitle(f"{panel.title}\n{panel.words}", x=0.03, ha="left", fontsize=13, color=INK)
    grid = figure.add_gridspec(rows + 1, COLUMNS, height_ratios=[0.8] + [1.0] * rows)
    _draw_gains(figure.add_subplot(grid[0, :]), panel)
    for place, name in enumerate(after):
        axes = figure.add_subplot(grid[1 + place // COLUMNS, place % COLUMNS])
        draw_belief(axes, name, panel.before[name], after[name], legend=place == 0)
    canvas.draw()
    return np.array(canvas.buffer_rgba())[..., :3].copy()


def _draw_gains(axes: Axes, panel: Panel) -> None:
    """A bar for each action; the one chosen is dark."""
    bits = [panel.gains_bits.get(name, 0.0) for name in panel.actions]
    colours = [BLUE if name == panel.chosen else PALE for name in panel.actions]
    axes.barh(range(len(bits)), bits, 0.72, color=colours)
    axes.set_yticks(range(len(bits)), panel.actions, fontsize=9, color=INK)
    axes.set_ylim(max(len(bits), 1) - 0.5, -0.5)
    axes.set_xlim(min(0.0, *bits), max(1.0, *bits))
    axes.set_xlabel("expected gain [bits]", fontsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8, color=GREY)
