"""The figures of a comparison, drawn from its table alone."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.experiments.comparison.cost_findings import Stopped, stopped
from palpate.experiments.comparison.cost_sections import PRICES
from palpate.experiments.comparison.findings import under_changes
from palpate.experiments.comparison.plan import IN_MODEL
from palpate.experiments.comparison.results import Results
from palpate.experiments.statistics import Contrast
from palpate.figures.palette import GREY, INK, PALE, plain, save, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_comparison"]

COLOURS = {
    "exact-greedy": "#0072b2",
    "exact-per-cost": "#56b4e9",
    "look-ahead-2": "#004b76",
    "actsel": "#d55e00",
    "actsel-best-case": "#e69f00",
    "actsel-repaired": "#cc79a7",
    "actsel-as-written": "#882255",
    "actsel-scored-exact": "#009e73",
    "greedy-scored-actsel": "#cc79a7",
    "rand-scored-exact": GREY,
    "rand-scored-actsel": "#b5a48b",
}
WHOLE = {
    "exact-greedy": "exact greedy",
    "actsel-best-case": "ACTSEL, best case",
    "actsel-repaired": "ACTSEL, repaired",
    "actsel-as-written": "ACTSEL, as written",
    "actsel": "ACTSEL, as released",
    "rand-scored-exact": "any order, exact beliefs",
}
APART = {
    "exact-greedy": "exact greedy",
    "actsel-scored-exact": "ACTSEL's choices, exact beliefs",
    "greedy-scored-actsel": "exact greedy's choices, ACTSEL's beliefs",
    "actsel": "ACTSEL, as released",
    "rand-scored-exact": "any order, exact beliefs",
    "rand-scored-actsel": "any order, ACTSEL's beliefs",
}
STOPPING = {
    "exact-greedy": "exact greedy",
    "exact-per-cost": "exact, gain per cost",
    "actsel-best-case": "ACTSEL, best case",
    "actsel": "ACTSEL, as released",
}
GAINS = {
    "exact-greedy": "exact greedy",
    "actsel-best-case": "ACTSEL, best case",
    "actsel": "ACTSEL, as released",
}


def draw_comparison(results: Results, folder: Path) -> dict[str, Path]:
    """Draw what the table of a comparison holds.

    Parameters
    ----------
    folder
        Where the pictures go; it exists.

    Returns
    -------
    dict
        What a picture shows, to its file.
    """
    own = results.where(world=IN_MODEL)
    _draw_learning(own, folder / "learning.png")
    _draw_worlds(under_changes(results), folder / "worlds.png")
    _draw_stopping(own, folder / "stopping.png")
    _draw_gains(own, folder / "gains.png")
    return {
        "Cross-entropy of the truth by number of actions, in-model, with 95 % intervals": folder / "learning.png",
        "Exact greedy against ACTSEL in all worlds": folder / "worlds.png",
        "Stopping by a price of time": folder / "stopping.png",
        "Expected and realised gain": folder / "gains.png",
    }


def _there(own: Results, names: Mapping[str, str]) -> dict[str, str]:
    methods = set(own.distinct("method"))
    return {name: words for name, words in names.items() if name in methods}


def _draw_learning(own: Results, path: Path) -> None:
    """Two panels: methods as they are, and choices and beliefs taken apart."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 5.2), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    titles = ("Methods with their own beliefs", "Choices and beliefs taken apart")
    for axes, names, title in zip(panels, (WHOLE, APART), titles, strict=True):
        for name, words in _there(own, names).items():
            curve = own.where(method=name).curve("cross_entropy_bits")
            axes.plot(curve.steps, curve.mean, "o-", color=COLOURS[name], lw=1.8, ms=4, label=words)
            axes.fill_between(curve.steps, curve.low, curve.high, color=COLOURS[name], alpha=0.13, lw=0)
        plain(axes, title)
        axes.set_xlabel("actions taken")
        whole(axes.xaxis)
        axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    panels[0].set_ylabel("cross-entropy of the truth [bits]\nmean of category and material")
    panels[0].set_ylim(bottom=0)
    save(figure, path)


def _draw_worlds(found: Mapping[str, tuple[Contrast, Contrast]], path: Path) -> None:
    """A row for each world: the differences with their intervals."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.2, 1.3 + 0.42 * len(found)), layout="constrained")
    axes = figure.subplots()
    axes.axvline(0, color=PALE, lw=1.5, zorder=0)
    for place, (words, name) in enumerate((("as released", "actsel"), ("best case", "actsel-best-case"))):
        pairs = [pair[place] for pair in found.values()]
        means = [one.mean for one in pairs]
        reach = [[one.mean - one.low for one in pairs], [one.high - one.mean for one in pairs]]
        rows = np.arange(len(pairs)) + 0.2 * (place - 0.5)
        label = f"exact greedy less ACTSEL, {words}"
        axes.errorbar(means, rows, xerr=reach, fmt="o", color=COLOURS[name], ms=5, lw=1.6, label=label)
    axes.set_yticks(range(len(found)), [f"{name} ({pair[0].objects})" for name, pair in found.items()])
    axes.invert_yaxis()
    plain(axes, "Below zero: exact greedy is nearer to the truth (number of objects in brackets)")
    axes.set_xlabel("difference of the cross-entropy of the truth, mean of all steps [bits], with 95 % interval")
    figure.legend(loc="outside upper center", ncols=2, frameon=False, fontsize=8.5)
    save(figure, path)


def _draw_stopping(own: Results, path: Path) -> None:
    """What stopping at a price costs, in bits and in mistakes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 4.2), layout="constrained")
    bits, mistakes = figure.subplots(1, 2)
    for name, words in _there(own, STOPPING).items():
        part = own.where(method=name)
        sweep = [stopped(part, "worth_bits_per_s", price) for price in PRICES]
        rule = stopped(part, "best_gain_bits", 0.0 if name.startswith("actsel") else 0.05)
        _draw_sweep(bits, [(s.cost_s, s.cross_entropy_bits) for s in (*sweep, rule)], COLOURS[name], words)
        _draw_sweep(mistakes, [_mistakes(s) for s in (*sweep, rule)], COLOURS[name], words)
    plain(bits, "What is known when it stops, and what it cost")
    bits.set_xlabel("cost [s]")
    bits.set_ylabel("cross-entropy of the truth [bits]")
    bits.set_ylim(bottom=0)
    plain(mistakes, "Stopping too soon, and too late, on the method's own path")
    mistakes.set_xlabel("actions after the answer was right for good")
    mistakes.set_ylabel("stopped too soon [% of the objects]")
    mistakes.set_ylim(bottom=-1)
    bits.plot([], [], "D", color=INK, ms=6, label="its own rule", linestyle="none")
    bits.legend(frameon=False, fontsize=8)
    save(figure, path)


def _mistakes(found: Stopped) -> tuple[float, float]:
    return found.wasted, 100 * found.premature


def _draw_sweep(axes: Axes, points: list[tuple[float, float]], colour: str, words: str) -> None:
    """A line over the prices, and a diamond for the method's own rule, the last point."""
    x, y = zip(*points, strict=True)
    axes.plot(x[:-1], y[:-1], "o-", color=colour, lw=1.6, ms=4, label=words)
    axes.plot(x[-1:], y[-1:], "D", color=colour, ms=7, markeredgecolor=INK, markeredgewidth=0.8)


def _draw_gains(own: Results, path: Path) -> None:
    """What the actions taken were expected to tell, and what they told."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.subplots()
    axes.axhline(0, color=PALE, lw=1.5, zorder=0)
    for name, words in _there(own, GAINS).items():
        part = own.where(method=name)
        steps = [int(step) for step in part.distinct("step") if step]
        for what, style in (("expected", "o-"), ("realised", "s--")):
            rows = [part.where(step=step) for step in steps]
            means = [row.mean(row.numbers(f"{what}_gain_bits")) for row in rows]
            axes.plot(steps, means, style, color=COLOURS[name], lw=1.6, ms=4, label=f"{words}: {what}")
    plain(axes, "Gain of the action taken")
    axes.set_xlabel("action")
    axes.set_ylabel("bits")
    whole(axes.xaxis)
    figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    save(figure, path)
