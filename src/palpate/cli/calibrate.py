"""`palpate calibrate`: sensor models from what a robot measures on known objects."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.calibrate_options import Measured
from palpate.cli.fit_options import How, OfStore, Tables
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place
from palpate.cli.task_options import Running

__all__ = ["calibrate"]


@spread
def calibrate(
    like: Annotated[
        str, typer.Option(metavar="NETWORK", help="Whose sensors are calibrated, all else kept: shipped, or a file.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The TOML file to write.")],
    place: Place,
    of_store: OfStore,
    running: Running,
    measured: Measured,
    how: How,
    outcomes: Annotated[
        Path | None,
        typer.Option(help="Folder in which outcomes are kept (default: beside the file, NAME-outcomes)."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if there is one.")] = False,
) -> None:
    """Measure known objects many times, and write what the sensors are really like into a network."""
    from palpate.cli.calibrating import OnRobot, SensorsOf
    from palpate.cli.fit_data import DataFrom, From
    from palpate.cli.fitting import fit_network

    on_robot = OnRobot(measured, running, outcomes or output.with_name(f"{output.stem}-outcomes"))
    on_robot.check_beside(place, of_store)
    source: DataFrom = From(place, of_store, Tables()) if measured.robot is None else on_robot
    fit_network(like, source, SensorsOf(measured.actions), output, how, force=force)
