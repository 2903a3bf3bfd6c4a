"""The picture of an episode: gains over the steps, actions taken, belief before and after."""

from __future__ import annotations

from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING

from palpate.episode import Episode, LoggedStep
from palpate.summary import CategoricalSummary, ContinuousSummary, Summary
from palpate.wording import outcome_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_belief", "draw_episode"]

BEFORE, AFTER, INK = "#b8bcc2", "#1f6f8b", "#22272e"
COLUMNS = 3


def draw_episode(episode: Episode, path: str | Path) -> None:
    """Draw an episode from its log alone.

    Above: the expected gain of every action that could be taken, step by step, with the action
    taken outlined and its realised gain as a diamond. Below: the belief about every property at
    the start and at the end; densities are scaled to their maximum.

    Parameters
    ----------
    path
        Where to write; the ending (.png, .svg, .pdf) says what.
    """
    from matplotlib.figure import Figure

    names = list(episode.prior)
    rows = -(-len(names) // COLUMNS)
    figure = Figure(figsize=(11, 3.4 + 2.5 * rows), layout="constrained")
    grid = figure.add_gridspec(rows + 1, COLUMNS, height_ratios=[1.25] + [1] * rows)
    _draw_gains(figure.add_subplot(grid[0, :]), episode)
    for place, name in enumerate(names):
        axes = figure.add_subplot(grid[1 + place // COLUMNS, place % COLUMNS])
        draw_belief(axes, name, episode.prior[name], episode.posterior[name], legend=place == 0)
    figure.savefig(path, dpi=150)


def _draw_gains(axes: Axes, episode: Episode) -> None:
    """Grouped bars: a group per decision, the last one for what was left at the end."""
    decisions = [step.gains_bits for step in episode.steps]
    if episode.gains_left_bits:
        decisions.append(episode.gains_left_bits)
    actions = list(dict.fromkeys([*episode.about.costs_s, *(action for gains in decisions for action in gains)]))
    width = 0.8 / max(1, len(actions))
    for place, action in enumerate(actions):
        at = [
            step + (place - (len(actions) - 1) / 2) * width for step, gains in enumerate(decisions) if action in gains
        ]
        bits = [gains[action] for gains in decisions if action in gains]
        axes.bar(at, bits, width, label=action, color=f"C{place % 10}", alpha=0.75)
    for step in episode.steps:
        _mark_chosen(axes, step, step.index - 1 + (actions.index(step.action) - (len(actions) - 1) / 2) * width, width)
    axes.set_xticks(range(len(decisions)), [_tick(episode, step) for step in range(len(decisions))])
    axes.set_xlim(-0.6, max(1, len(decisions)) - 0.4)
    axes.set_ylabel(f"gain on {episode.about.objective} [bits]")
    axes.set_title(_title(episode), loc="left", fontsize=11)
    if actions:
        axes.legend(frameon=False, fontsize=8, ncols=4, loc="upper right")
    lowest, highest = axes.get_ylim()
    if lowest < 0:  # the paper's gains can be negative
        axes.axhline(0, color=INK, linewidth=0.8)
    axes.set_ylim(min(lowest, 0), 1.15 * highest)  # room for the legend
    _tidy(axes)


def _mark_chosen(axes: Axes, step: LoggedStep, at: float, width: float) -> None:
    label = "taken" if step.index == 1 else None
    axes.bar([at], [step.expected_gain_bits], width, fill=False, edgecolor=INK, linewidth=1.8, label=label)
    if step.realised_gain_bits is not None:
        label = "realised" if step.index == 1 else None
        axes.plot([at], [step.realised_gain_bits], "D", color=INK, markersize=5, linestyle="none", label=label)


def _tick(episode: Episode, place: int) -> str:
    """The step, its action and what it returned."""
    if place >= len(episode.steps):
        return "left"
    step = episode.steps[place]
    returned = shorten(outcome_words(step.admitted), 20, placeholder="...")
    return f"{step.index}. {step.action}\n{returned}"


def _title(episode: Episode) -> str:
    subject = episode.about.object or "An object"
    end = f"stopped: {episode.stop}" if episode.stop else "interrupted"
    return f"{subject} ({episode.network}); {end}"


def draw_belief(axes: Axes, name: str, before: Summary, after: Summary, *, legend: bool) -> None:
    """Draw what was and what is believed of a property: bars of states, or densities scaled to their maximum."""
    if isinstance(before, CategoricalSummary) and isinstance(after, CategoricalSummary):
        _draw_states(axes, before, after)
        axes.set_title(name, loc="left", fontsize=10)
    elif isinstance(before, ContinuousSummary) and isinstance(after, ContinuousSummary):
        _draw_densities(axes, before, after)
        axes.set_title(f"{name} [{before.unit}]", loc="left", fontsize=10)
    else:
        axes.set_title(name, loc="left", fontsize=10)
        axes.text(0.5, 0.5, "not said by this engine", ha="center", va="center", fontsize=8, transform=axes.transAxes)
        axes.set_xticks([])
        axes.set_yticks([])
        return
    if legend:
        axes.legend(frameon=False, fontsize=8)
    _tidy(axes)


def _draw_states(axes: Axes, before: CategoricalSummary, after: CategoricalSummary) -> None:
    places = range(len(before.probabilities))
    axes.barh([y - 0.2 for y in places], list(before.probabilities.values()), 0.36, color=BEFORE, label="before")
    axes.barh([y + 0.2 for y in places], list(after.probabilities.values()), 0.36, color=AFTER, label="after")
    axes.set_yticks(places, list(before.probabilities), fontsize=7)
    axes.invert_yaxis()
    axes.set_xlim(0, 1)


def _draw_densities(axes: Axes, before: ContinuousSummary, after: ContinuousSummary) -> None:
    for summary, colour, label in ((before, BEFORE, "before"), (after, AFTER, "after")):
        peak = max(summary.density)
        heights = [density / peak for density in summary.density]
        axes.fill_between(summary.x, heights, color=colour, alpha=0.45, linewidth=0, label=label)
        axes.plot(summary.x, heights, color=colour, linewidth=1.4)
    axes.set_xlim(*_range(before, after))
    axes.set_ylim(0, 1.08)
    axes.set_yticks([])
    axes.set_ylabel("scaled to maximum", fontsize=7)


def _range(*summaries: ContinuousSummary) -> tuple[float, float]:
    """Where the mass is: heavy tails would leave no room for it."""
    low, high = [], []
    for summary in summaries:
        q05, q95 = summary.quantiles["0.05"], summary.quantiles["0.95"]
        low.append(max(summary.x[0], q05 - 0.5 * (q95 - q05)))
        high.append(min(summary.x[-1], q95 + 0.5 * (q95 - q05)))
    return min(low), max(high)


def _tidy(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)
