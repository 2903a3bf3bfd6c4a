"""Small tasks for tests, in a module of their own: worker processes must be able to import them."""

from __future__ import annotations

import os
import signal
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.experiments.workers import Row


@dataclass(frozen=True)
class Draw:
    """Draws a few numbers from its own seed."""

    number: int

    @property
    def key(self) -> str:
        return f"draw-{self.number}"

    def run(self) -> list[Row]:
        rng = np.random.default_rng(np.random.SeedSequence(7, spawn_key=(self.number,)))
        product = rng.normal(size=(200, 200)) @ rng.normal(size=(200, 200))
        return [{"task": self.number, "row": row, "value": float(product[row].sum()), "none": None} for row in range(3)]


@dataclass(frozen=True)
class Deadly:
    """Kills its worker the first time, or each time, and then does the work of another task."""

    inner: Draw
    trace: Path
    always: bool = False

    @property
    def key(self) -> str:
        return self.inner.key

    def run(self) -> list[Row]:
        if self.always or not self.trace.exists():
            self.trace.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return self.inner.run()


@dataclass(frozen=True)
class Stopper:
    """Is interrupted as by Ctrl-C while it works."""

    key: str = "stopper"

    def run(self) -> list[Row]:
        raise KeyboardInterrupt
