"""`palpate benchmark`: exact inference, the paper's method and chance on the same outcomes; or the bench in physics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.calibrate import RobotKind
from palpate.cli.spreading import spread
from palpate.cli.task_options import WHAT, Running, Seed

__all__ = ["benchmark"]


@spread
def benchmark(
    running: Running,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for the table, figures and the report.")
    ] = Path("benchmark"),
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer objects and methods: under a minute.", rich_help_panel=WHAT)
    ] = False,
    calibration: Annotated[
        bool,
        typer.Option(
            "--calibration",
            help="Not a comparison: whether exact beliefs about many drawn objects are calibrated.",
            rich_help_panel=WHAT,
        ),
    ] = False,
    robot: Annotated[
        RobotKind,
        typer.Option(
            help="Outcomes drawn from a network, or the known objects on the bench in physics, each with sensors "
            "calibrated on the others.",
            rich_help_panel=WHAT,
        ),
    ] = RobotKind.SAMPLED,
    repetitions: Annotated[
        int | None,
        typer.Option(min=2, help="On the bench: of each action on each object (default: 10).", rich_help_panel=WHAT),
    ] = None,
    objects: Annotated[
        int | None,
        typer.Option(
            min=2,
            help="Objects drawn in the in-model world (default: 300, 24 if quick, 20000 for a calibration).",
            rich_help_panel=WHAT,
        ),
    ] = None,
    network: Annotated[
        str,
        typer.Option(
            help="Shipped network or TOML file to draw from and to believe (default: household-filled).",
            rich_help_panel=WHAT,
        ),
    ] = "household-filled",
    seed: Seed = 0,
    figures_only: Annotated[
        bool, typer.Option("--figures-only", help="Draw figures and report again from the table of a finished run.")
    ] = False,
) -> None:
    """Compare exact inference, the paper's method and chance on the same simulated outcomes."""
    from palpate.cli import benchmarking, benchmarking_bench

    benchmarking.check_together(robot is RobotKind.MUJOCO, quick, calibration, objects, repetitions)
    how = vars(running)
    if robot is RobotKind.MUJOCO and not figures_only:
        benchmarking_bench.run(network, repetitions or 10, seed, output, **how)
        benchmarking.tell(output)
        return
    asked = benchmarking.Asked(quick=quick, calibration=calibration, objects=objects, seed=seed, network=network)
    if not figures_only:
        benchmarking.run(asked, output, **how)
    benchmarking.tell(output)
