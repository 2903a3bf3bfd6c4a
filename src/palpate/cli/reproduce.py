"""`palpate reproduce`: the paper's experiments, their figures, and which of its claims hold."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.task_options import WHAT, Running, Seed

__all__ = ["reproduce"]


@spread
def reproduce(
    running: Running,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for tables, figures and the report.")] = Path(
        "reproduction"
    ),
    engine: Annotated[
        list[str] | None,
        typer.Option(help="exact or message-passing; may be repeated (default: both).", rich_help_panel=WHAT),
    ] = None,
    preset: Annotated[
        list[str] | None,
        typer.Option(
            help="Message passing as-released (default), repaired or as-written; may be repeated.", rich_help_panel=WHAT
        ),
    ] = None,
    network: Annotated[
        list[str] | None,
        typer.Option(
            help="Shipped network or TOML file; the first is the main one (default: household-filled, and household "
            "beside).",
            rich_help_panel=WHAT,
        ),
    ] = None,
    learn: Annotated[
        list[str] | None,
        typer.Option(help="One of the paper's objectives; may be repeated (default: all).", rich_help_panel=WHAT),
    ] = None,
    thing: Annotated[
        list[str] | None,
        typer.Option("--object", help="One of the objects; may be repeated (default: all).", rich_help_panel=WHAT),
    ] = None,
    repetitions: Annotated[
        int | None, typer.Option(min=1, help="Repetitions of each object (default: 5).", rich_help_panel=WHAT)
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            help="Folder of recordings in the published layout, in place of drawn ones.", rich_help_panel=WHAT
        ),
    ] = None,
    seed: Seed = 0,
    figures_only: Annotated[
        bool, typer.Option("--figures-only", help="Draw figures and report again from the tables of a finished run.")
    ] = False,
) -> None:
    """Run the paper's experiments, draw its figures, and say which of its claims hold."""
    from palpate.cli import reproducing

    if not figures_only:
        planned = reproducing.planned(
            engines=engine or [],
            presets=preset or [],
            networks=network or [],
            objectives=learn or [],
            objects=thing or [],
            repetitions=repetitions,
            data=data,
            seed=seed,
        )
        reproducing.run(planned, output, **vars(running))
    reproducing.tell(output)
