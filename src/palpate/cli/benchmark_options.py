"""Options of `palpate benchmark`, for `palpate.cli.spreading.spread`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from palpate.cli.task_options import WHAT, RobotKind, Seed

__all__ = ["Compared"]


@dataclass(frozen=True)
class Compared:
    """What is compared, and on which outcomes; None where nothing was typed."""

    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer objects and methods: under a minute.", rich_help_panel=WHAT)
    ] = False
    calibration: Annotated[
        bool,
        typer.Option(
            "--calibration",
            help="Not a comparison: whether exact beliefs about many drawn objects are calibrated.",
            rich_help_panel=WHAT,
        ),
    ] = False
    robot: Annotated[
        RobotKind,
        typer.Option(
            help="Outcomes drawn from a network, or the known objects on the bench in physics, each with sensors "
            "calibrated on the others.",
            rich_help_panel=WHAT,
        ),
    ] = RobotKind.SAMPLED
    repetitions: Annotated[
        int | None,
        typer.Option(min=2, help="On the bench: of each action on each object (default: 10).", rich_help_panel=WHAT),
    ] = None
    objects: Annotated[
        int | None,
        typer.Option(
            min=2,
            help="Objects drawn in the in-model world (default: 300, 24 if quick, 20000 for a calibration).",
            rich_help_panel=WHAT,
        ),
    ] = None
    network: Annotated[
        str,
        typer.Option(
            help="Shipped network or TOML file to draw from and to believe.",
            rich_help_panel=WHAT,
        ),
    ] = "household-filled"
    seed: Seed = 0

    @property
    def on_bench(self) -> bool:
        """Whether known objects are measured on the bench in physics."""
        return self.robot is RobotKind.MUJOCO
