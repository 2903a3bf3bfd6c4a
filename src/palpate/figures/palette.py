"""Colours that people with any kind of colour vision can tell apart, and plain axes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

__all__ = ["BLUE", "GREY", "INK", "ORANGE", "PALE", "action_colours", "legend_above", "plain", "save", "whole"]

INK, GREY, PALE = "#22272e", "#8a9099", "#e3e5e8"
BLUE, ORANGE = "#0f5f99", "#d55e00"

# Okabe and Ito (2008), without yellow and black, which thin lines and white paper do not bear.
DISTINCT = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")


def action_colours(actions: Sequence[str]) -> dict[str, str]:
    """A colour for each action, the same in every picture of the same repertoire.

    Examples
    --------
    >>> action_colours(["weighing", "squeezing"])
    {'weighing': '#0072b2', 'squeezing': '#d55e00'}
    """
    return {action: DISTINCT[place % len(DISTINCT)] for place, action in enumerate(actions)}


def plain(axes: Axes, title: str = "") -> None:
    """Leave out what says nothing, and put the title to the left."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8, color=GREY)
    axes.yaxis.label.set_fontsize(8.5)
    axes.xaxis.label.set_fontsize(8.5)
    if title:
        axes.set_title(title, loc="left", fontsize=9.5, color=INK)


def whole(axis: Axis) -> None:
    """Ticks at whole numbers only."""
    from matplotlib.ticker import MaxNLocator

    axis.set_major_locator(MaxNLocator(integer=True))


def legend_above(figure: Figure, axes: Axes, title: str = "") -> None:
    """Put the legend of a panel above all panels, under a title where there is one."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        title=title or None,
        title_fontsize=11,
        loc="outside upper center",
        ncols=len(labels),
        frameon=False,
        fontsize=9,
    )


def save(figure: Figure, path: Path) -> None:
    """Write a picture of as many dots as pages and reports need."""
    figure.savefig(path, dpi=110)
