"""`palpate calibrate`: sensor models from what a robot measures on known objects."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.fit_options import How, OfStore, Tables
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place
from palpate.cli.task_options import WHAT, Running, Seed

__all__ = ["RobotKind", "calibrate"]

HOW = "How sensors are fitted"


class RobotKind(Enum):
    """Who measures."""

    SAMPLED = "sampled"
    MUJOCO = "mujoco"


@spread
def calibrate(
    like: Annotated[
        str, typer.Option(metavar="NETWORK", help="Whose sensors are calibrated, all else kept: shipped, or a file.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The TOML file to write.")],
    place: Place,
    of_store: OfStore,
    running: Running,
    robot: Annotated[
        RobotKind | None,
        typer.Option(
            help="Who measures: the bench in physics, or draws from a network (default: recordings of a store).",
            rich_help_panel=WHAT,
        ),
    ] = None,
    world: Annotated[
        str | None,
        typer.Option(
            metavar="NETWORK",
            help="From whose sensors the sampled robot draws (default: --like).",
            rich_help_panel=WHAT,
        ),
    ] = None,
    thing: Annotated[
        list[str] | None,
        typer.Option("--object", help="An object to measure; repeatable (default: all known).", rich_help_panel=WHAT),
    ] = None,
    action: Annotated[
        list[str] | None,
        typer.Option(help="An action to calibrate; repeatable (default: all).", rich_help_panel=WHAT),
    ] = None,
    times: Annotated[
        int, typer.Option(min=1, help="How often each action is done on each object.", rich_help_panel=WHAT)
    ] = 20,
    seed: Seed = 0,
    outcomes: Annotated[
        Path | None,
        typer.Option(help="Folder in which outcomes are kept (default: beside the file, NAME-outcomes)."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if there is one.")] = False,
    pseudo_count: Annotated[float, typer.Option(help="Added to each count of a table.", rich_help_panel=HOW)] = 0.2,
    folds: Annotated[
        int, typer.Option(help="Of the objects, to score on those held out; 0: none.", rich_help_panel=HOW)
    ] = 10,
    date: Annotated[
        str | None, typer.Option(help="Of the network (default: that of the last recording).", rich_help_panel=HOW)
    ] = None,
) -> None:
    """Measure known objects many times, and write what the sensors are really like into a network."""
    from palpate.cli.calibrating import OnRobot, SensorsOf
    from palpate.cli.fit_data import DataFrom, From
    from palpate.cli.fitting import fit_network

    actions = tuple(action or ())
    measured = OnRobot(
        robot=robot.value if robot else None,
        world=world,
        things=tuple(thing or ()),
        actions=actions,
        times=times,
        seed=seed,
        folder=outcomes or output.with_name(f"{output.stem}-outcomes"),
        **vars(running),
    )
    measured.check_beside(place, of_store)
    source: DataFrom = measured if robot is not None else From(place, of_store, Tables())
    how = How(pseudo_count, None, folds, date)
    fit_network(like, source, output, how, force=force, part=SensorsOf(actions))
