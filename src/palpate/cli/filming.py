"""`palpate explore --video`: the scene, and the belief beside it."""

from __future__ import annotations

from dataclasses import replace
from textwrap import shorten
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from palpate.explore import Step
from palpate.figures.belief_panel import Panel, draw_panel
from palpate.figures.film import RATE_HZ, Film
from palpate.outcomes import Outcome
from palpate.robots.mujoco.camera import Camera
from palpate.robots.mujoco.furniture import OVERVIEW
from palpate.robots.mujoco.motion import TICK_S
from palpate.robots.signals import ImageSignals, Signals
from palpate.selection.policies import Choice
from palpate.summary import summarise
from palpate.wording import number, outcome_words

if TYPE_CHECKING:
    from palpate.robots.mujoco.scene import Scene

__all__ = ["SIZE", "Filming"]

SCENE, PANEL = (960, 720), (640, 720)
SIZE = (SCENE[0] + PANEL[0], SCENE[1])
FASTER = 3
"""The scene is shown so many times as fast as it is."""
TICKS = round(FASTER / (RATE_HZ * TICK_S))
LONGEST = 66
STILL_S = 2.0
"""How long a result is shown."""
INSET, EDGE = 3, 4
"""The camera's image is shown in a corner, so many times smaller, with a white edge [pixels]."""
Pixels = NDArray[np.uint8]


class Filming:
    """Films an exploration on the bench; what it draws with is let go of at the end.

    Parameters
    ----------
    film
        Where pictures go; closed at the end.
    panel
        What stands beside the scene in the beginning.
    """

    def __init__(self, film: Film, scene: Scene, panel: Panel) -> None:
        self._film, self._camera = film, Camera(scene, SCENE)
        self._panel = panel
        self._ticks = 0
        self._inset: Pixels | None = None

    def __enter__(self) -> Self:
        try:
            self._redraw()
            self._show(STILL_S / 2)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._camera.close()
        self._film.close()

    def chosen(self, choice: Choice, action: str) -> None:
        """Show the gains, and what is done now."""
        self._inset = None
        words = f"step {len(choice.taken) + 1}: {action} ..."
        self._panel = replace(self._panel, words=words, gains_bits=dict(choice.gains), chosen=action)
        self._redraw()
        self._show(STILL_S / 2)

    def seen(self, scene: Scene) -> None:
        """Film the scene where it is time for another picture."""
        self._ticks += 1
        if self._ticks % TICKS == 0:
            self._show()

    def measured(self, action: str, signals: Signals, outcome: Outcome) -> None:
        """Show what the camera saw."""
        if isinstance(signals, ImageSignals):
            self._inset = signals.image[::INSET, ::INSET]

    def learned(self, step: Step) -> None:
        """Show the outcome and the new belief, or why it is over."""
        if step.action is None or step.outcome is None:
            words = f"stopped: {step.stop}"
        else:
            gain = "" if step.realised_gain_bits is None else f" ({number(step.realised_gain_bits)} bits)"
            # what the classifier said can be long, and is what may be cut
            words = f"step {step.index}{gain}: {step.action} gave {outcome_words(step.outcome)}"
        words = shorten(words, LONGEST, placeholder="...")
        self._panel = replace(self._panel, words=words, after=summarise(step.after))
        self._redraw()
        self._show(STILL_S)

    def _redraw(self) -> None:
        self._side = draw_panel(self._panel, PANEL)

    def _show(self, seconds: float = 0.0) -> None:
        scene = self._camera.image(OVERVIEW)
        if self._inset is not None:
            height, width = self._inset.shape[:2]
            scene[-height - 2 * EDGE :, : width + 2 * EDGE] = 255
            scene[-height - EDGE : -EDGE, EDGE : width + EDGE] = self._inset
        self._film.add(np.hstack([scene, self._side]), seconds)
