"""`palpate benchmark`: exact inference, the paper's method and chance on the same outcomes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["benchmark"]

WHAT, HOW = "What is run", "How it is run"


def benchmark(
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
    seed: Annotated[int, typer.Option(min=0, help="Seed of all chance.", rich_help_panel=WHAT)] = 0,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Worker processes (default: one per processor).", rich_help_panel=HOW)
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of a Dask scheduler to run on, such as tcp://host:8786.", rich_help_panel=HOW),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on where a run in the same folder was stopped.", rich_help_panel=HOW)
    ] = False,
    figures_only: Annotated[
        bool, typer.Option("--figures-only", help="Draw figures and report again from the table of a finished run.")
    ] = False,
) -> None:
    """Compare exact inference, the paper's method and chance on the same simulated outcomes."""
    from palpate.cli import benchmarking

    asked = benchmarking.Asked(quick=quick, calibration=calibration, objects=objects, seed=seed, network=network)
    if not figures_only:
        benchmarking.run(asked, output, workers=workers, scheduler=scheduler, resume=resume)
    benchmarking.tell(output)
