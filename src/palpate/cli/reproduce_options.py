"""Options of `palpate reproduce`, for `palpate.cli.spreading.spread`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.task_options import WHAT, Seed

__all__ = ["Experiments"]


@dataclass(frozen=True)
class Experiments:
    """Which of the paper's experiments are run, and how; None where nothing was typed."""

    engine: Annotated[
        list[str] | None,
        typer.Option(help="exact or message-passing; may be repeated (default: both).", rich_help_panel=WHAT),
    ] = None
    preset: Annotated[
        list[str] | None,
        typer.Option(
            help="Message passing as-released (default), repaired or as-written; may be repeated.", rich_help_panel=WHAT
        ),
    ] = None
    network: Annotated[
        list[str] | None,
        typer.Option(
            help="Shipped network or TOML file; the first is the main one (default: household-filled, and household "
            "beside).",
            rich_help_panel=WHAT,
        ),
    ] = None
    learn: Annotated[
        list[str] | None,
        typer.Option(help="One of the paper's objectives; may be repeated (default: all).", rich_help_panel=WHAT),
    ] = None
    thing: Annotated[
        list[str] | None,
        typer.Option("--object", help="One of the objects; may be repeated (default: all).", rich_help_panel=WHAT),
    ] = None
    repetitions: Annotated[
        int | None, typer.Option(min=1, help="Repetitions of each object (default: 5).", rich_help_panel=WHAT)
    ] = None
    data: Annotated[
        Path | None,
        typer.Option(
            help="Folder of recordings in the published layout, in place of drawn ones.", rich_help_panel=WHAT
        ),
    ] = None
    seed: Seed = 0
