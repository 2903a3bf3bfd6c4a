"""What a page reads and draws at most, whatever is asked of it."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.server.memory import Held

__all__ = ["MOST_DRAWN", "MOST_FITTED", "MOST_NUMBERS", "Allowance"]

MOST_NUMBERS = 4_000_000
"""Of samples and time stamps that are read to be drawn: a minute and a half of sound."""
DRAWN_BYTES = 27
"""Of memory that a number takes while it is drawn."""
MOST_FITTED = 40_000
"""Samples of squeezes to which lines are fitted, which takes a second or two: half a minute at a kilohertz."""
MOST_DRAWN = 60
"""Plots."""


@dataclass
class Allowance:
    """What is left of it: `numbers` may still be read, `plots` drawn, and lines fitted to `samples`.

    What is read takes `memory`, where that is told.

    Examples
    --------
    >>> left = Allowance(numbers=10)
    >>> left.reads(7), left.reads(7), left.reads(3)
    (True, False, True)
    """

    numbers: int = MOST_NUMBERS
    plots: int = MOST_DRAWN
    samples: int = MOST_FITTED
    memory: Held | None = None

    def reads(self, numbers: int) -> bool:
        """Take so many numbers; whether there were as many."""
        if numbers > self.numbers:
            return False
        self.numbers -= numbers
        if self.memory is not None:
            self.memory.take(DRAWN_BYTES * numbers)
        return True

    def fits(self, samples: int) -> bool:
        """Take so many samples; whether there were as many."""
        if samples > self.samples:
            return False
        self.samples -= samples
        return True

    def draws(self, most: int) -> int:
        """Take so many plots, or as many as there are."""
        taken = min(most, self.plots)
        self.plots -= taken
        return taken
