"""Labels of the lines at values that are known: whole, beside their lines, none over another one or over a point."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from palpate.invisible import shown
from palpate.server.plots.drawing import number, short
from palpate.server.plots.plot import Level
from palpate.server.plots.scale import Scale

__all__ = ["GAP", "LINE", "Labelled", "in_lines", "known_levels"]

MOST_OF_SOURCE, MOST_LINES = 32, 4
LETTER, GAP, LINE = 6.0, 4.0, 14.0
"""The width of a letter, about; the room between a label and its line; and the height of a line of labels."""


def known_levels(truths: Iterable[tuple[float, str]]) -> tuple[Level, ...]:
    """Values that are known, each with where it is known from; those that read alike once.

    Examples
    --------
    >>> [one.label for one in known_levels([(120.0, "a scale"), (999.0, "robot7"), (999.0, "robot7")])]
    ['true: 120 (a scale)', 'true: 999 (robot7)']
    """
    levels = (
        Level(value, f"true: {number(value)} ({short(shown(source), MOST_OF_SOURCE)})") for value, source in truths
    )
    return tuple({one.label: one for one in levels}.values())


@dataclass(frozen=True)
class Labelled:
    """Where the label of a level stands: at the right of its line, or at the left; in which line from below, from 0.

    `line` is None where there is no room any more.
    """

    level: Level
    line: int | None
    at_left: bool

    def ends(self, across: Scale) -> tuple[float, float]:
        """From where to where it reaches, with its line."""
        x, width = across.at(self.level.x), GAP + LETTER * len(self.level.label)
        return (x - width, x) if self.at_left else (x, x + width)


def in_lines(levels: Sequence[Level], across: Scale) -> list[Labelled]:
    """Find a place for each label, from the right: so no line crosses the label at the right of another one."""
    placed: list[Labelled] = []
    for level in sorted(levels, key=lambda one: -one.x):
        beyond = Labelled(level, None, at_left=False).ends(across)[1] > across.end
        tried = Labelled(level, None, at_left=beyond)
        low, high = tried.ends(across)
        above = (one for one in placed if one.ends(across)[0] <= high + GAP and one.ends(across)[1] >= low - GAP)
        line = max((-1 if one.line is None else one.line for one in above), default=-1) + 1
        placed.append(Labelled(level, line if level.label and line < MOST_LINES else None, at_left=beyond))
    return placed
