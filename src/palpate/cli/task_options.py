"""Options of commands that run tasks, for `palpate.cli.spreading.spread`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Annotated

import typer

__all__ = ["WHAT", "RobotKind", "Running", "Seed"]

WHAT, HOW = "What is run", "How it is run"

Seed = Annotated[int, typer.Option(min=0, help="Seed of all chance.", rich_help_panel=WHAT)]


class RobotKind(Enum):
    """Who measures."""

    SAMPLED = "sampled"
    MUJOCO = "mujoco"


@dataclass(frozen=True)
class Running:
    """Who does the work, and whether it goes on."""

    workers: Annotated[
        int | None, typer.Option(min=1, help="Worker processes (default: one per processor).", rich_help_panel=HOW)
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of a Dask scheduler to run on, such as tcp://host:8786.", rich_help_panel=HOW),
    ] = None
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on where a run in the same folder was stopped.", rich_help_panel=HOW)
    ] = False
