"""A picture of a network: its graph, and the prior density of every property with its components."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate.figures.layout import layered
from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.drawing import edges
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.patches import Patch

__all__ = ["draw_network"]

COLUMNS = 3
MOST_NAMED = 12
"""Components in a legend; with more, the names would hide the densities."""
POINTS = 800
BLUE, GREY = "#33628f", "#6b6b6b"
SHADE: Mapping[str, Any] = {"facecolor": "#ececec", "edgecolor": "black", "linewidth": 0.8}
Colours = Mapping[str, tuple[float, float, float, float]]


def draw_network(network: Network, path: str | Path) -> None:
    """Draw the graph above, and below it a panel with the prior of each property.

    A continuous property's density is shown with its components, one per configuration of its
    parents, weighted by the configuration's prior probability and coloured as the bars of the
    first parent's states. Derived properties have no components of their own.

    Parameters
    ----------
    path
        Where to write; the suffix gives the format (png, svg, pdf).
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    rows = ceil(len(network.properties) / COLUMNS)
    with mpl.rc_context({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(12, 4.2 + 2.7 * rows), layout="constrained")
        grid = figure.add_gridspec(rows + 1, COLUMNS, height_ratios=[4.2] + [2.7] * rows)
        _draw_graph(figure.add_subplot(grid[0, :]), network)
        belief, colours = ExactBelief(network), _colours(network)
        for index, prop in enumerate(network.properties.values()):
            row, column = divmod(index, COLUMNS)
            _draw_prior(figure.add_subplot(grid[row + 1, column]), belief, prop, colours)
        figure.savefig(path, dpi=150)


def _colours(network: Network) -> dict[str, Colours]:
    import matplotlib as mpl

    shades = mpl.colormaps["tab20"]
    return {p.name: {s: shades(i % 20) for i, s in enumerate(p.states)} for p in network.categorical}


def _draw_graph(axes: Axes, network: Network) -> None:
    axes.set_axis_off()
    axes.set_title(network.name, fontsize=12)
    names = [*network.properties, *(f"action:{name}" for name in network.actions)]
    layout = layered(names, edges(network))
    boxes = {name: _draw_node(axes, network, name, (x, -y)) for name, (x, y) in layout.nodes.items()}
    for (start, end), points in layout.edges.items():
        axes.plot([x for x, _ in points[:-1]], [-y for _, y in points[:-1]], color=GREY, lw=1, zorder=1)
        (x0, y0), (x1, y1) = points[-2:]
        # Above the boxes, as their outlines, where the arrow begins and ends, are known once drawn.
        arrow: dict[str, Any] = {"arrowstyle": "-|>", "color": GREY, "shrinkA": 0, "shrinkB": 0, "patchB": boxes[end]}
        if len(points) == 2:
            arrow |= {"patchA": boxes[start]}
        axes.annotate("", (x1, -y1), (x0, -y0), arrowprops=arrow, zorder=3)
    xs, ys = zip(*layout.nodes.values(), strict=True)
    axes.set_xlim(min(xs) - 0.6, max(xs) + 0.6)
    axes.set_ylim(-max(ys) - 0.4, 0.4)


def _draw_node(axes: Axes, network: Network, name: str, at: tuple[float, float]) -> Patch | None:
    """Draw a node and return its outline."""
    action = network.actions.get(name.removeprefix("action:")) if name.startswith("action:") else None
    box: dict[str, Any] = {"boxstyle": "round,pad=0.5", "facecolor": "white", "edgecolor": BLUE, "linewidth": 1.3}
    if action is not None:
        text = f"{action.name}, {action.cost_s:g} s"
        box |= {"boxstyle": "square,pad=0.4", "facecolor": "#e8e8e8", "edgecolor": GREY, "linewidth": 0.8}
    else:
        prop = network.properties[name]
        text = name if isinstance(prop, CategoricalProperty) else f"{name} [{prop.unit}]"
        if isinstance(prop, CategoricalProperty):
            box |= {"facecolor": "#dbe7f3"}
        elif isinstance(prop, DerivedProperty):
            box |= {"linestyle": "--"}
    return axes.text(*at, text, ha="center", va="center", bbox=box, zorder=2).get_bbox_patch()


def _draw_prior(axes: Axes, belief: ExactBelief, prop: Property, colours: Mapping[str, Colours]) -> None:
    axes.set_title(prop.name, fontsize=9, loc="left")
    if isinstance(prop, CategoricalProperty):
        axes.barh(prop.states, belief.probabilities(prop.name), color=list(colours[prop.name].values()))
        axes.invert_yaxis()
        axes.set_xlabel("probability")
        return
    axes.set_xlabel(prop.unit)
    axes.set_ylabel(f"density [per {prop.unit}]")
    marginal = belief.marginal(prop.name)
    assert isinstance(marginal, ContinuousMarginal)
    if isinstance(prop, ContinuousProperty):
        x = np.linspace(marginal.quantile(0.002), marginal.quantile(0.995), POINTS)
        _draw_mixture(axes, belief, prop, x, colours)
        axes.set_ylim(bottom=0)
    else:
        axes.fill_between(marginal.nodes, marginal.density, **SHADE)
        axes.set_xlim(marginal.quantile(0.002), marginal.quantile(0.995))
        # The density of a product may grow without limit at zero: show its body.
        body = marginal.nodes > marginal.quantile(0.03)
        axes.set_ylim(0, 1.1 * float(marginal.density[body].max()))


def _draw_mixture(
    axes: Axes, belief: ExactBelief, prop: ContinuousProperty, x: NDArray[np.float64], colours: Mapping[str, Colours]
) -> None:
    density = np.exp(prop.family.log_density(x))  # (configurations..., x)
    weight = belief.probabilities(*prop.parents) if prop.parents else np.ones(())
    parents = [belief.network.properties[name] for name in prop.parents]
    components = weight[..., None] * density
    axes.fill_between(x, components.reshape(-1, x.size).sum(axis=0), **SHADE)
    for where in np.ndindex(weight.shape) if parents else ():
        states = [p.states[i] for p, i in zip(parents, where, strict=True) if isinstance(p, CategoricalProperty)]
        axes.plot(x, components[where], label=", ".join(states), color=colours[prop.parents[0]][states[0]], lw=1.2)
    if parents and weight.size <= MOST_NAMED:
        axes.legend(fontsize=6, frameon=False, ncols=1 + (weight.size > 5))
    axes.set_xlim(x[0], x[-1])
