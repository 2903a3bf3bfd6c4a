"""What the terminal shows while the next action is being chosen, where that takes long."""

from __future__ import annotations

from time import monotonic

from rich.console import Group, RenderableType
from rich.spinner import Spinner

__all__ = ["Waiting"]

PATIENCE_S = 2.0
"""Choices that take less show nothing."""


class Waiting:
    """Nothing in the first seconds; then that a choice is being made, and how far it is."""

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Begin to wait for another choice."""
        self._since = monotonic()
        self._spinner = Spinner("dots", "Choosing the next action ...")

    def told(self, done: int, of: int) -> None:
        """Note how many actions have been valued, and of how many."""
        self._spinner.update(text=f"Choosing the next action ... {done} of {of} looked at")

    def __rich__(self) -> RenderableType:
        """The line to show now."""
        return self._spinner if monotonic() - self._since >= PATIENCE_S else Group()
