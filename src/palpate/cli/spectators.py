"""Who watches an exploration while it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, Self

from palpate.explore import Step
from palpate.outcomes import Outcome
from palpate.selection.policies import Choice

if TYPE_CHECKING:
    from palpate.robots.mujoco.scene import Scene
    from palpate.robots.signals import Signals

__all__ = ["Audience", "Spectator"]


class Spectator(Protocol):
    """Is told of everything, in the order in which it happens; let go of at the end."""

    def __enter__(self) -> Self:
        """It is there from the beginning."""

    def __exit__(self, *_: object) -> None:
        """Let go of all it holds."""

    def chosen(self, choice: Choice, action: str) -> None:
        """An action is about to be done."""

    def seen(self, scene: Scene) -> None:
        """A hundredth of a second of the scene has passed."""

    def measured(self, action: str, signals: Signals, outcome: Outcome) -> None:
        """An action gave signals."""

    def learned(self, step: Step) -> None:
        """A step is done."""


@dataclass(frozen=True)
class Audience:
    """All who watch, told one after the other."""

    spectators: Sequence[Spectator] = ()

    def chosen(self, choice: Choice, action: str) -> None:
        """Tell all of a choice."""
        for spectator in self.spectators:
            spectator.chosen(choice, action)

    def seen(self, scene: Scene) -> None:
        """Show all the scene."""
        for spectator in self.spectators:
            spectator.seen(scene)

    def measured(self, action: str, signals: Signals, outcome: Outcome) -> None:
        """Tell all of signals."""
        for spectator in self.spectators:
            spectator.measured(action, signals, outcome)

    def learned(self, step: Step) -> None:
        """Tell all of a step."""
        for spectator in self.spectators:
            spectator.learned(step)
