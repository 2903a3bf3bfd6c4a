"""`palpate reproduce`: the paper's experiments, their figures, and which of its claims hold."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.reproduce_options import Experiments
from palpate.cli.spreading import spread
from palpate.cli.task_options import Running

__all__ = ["reproduce"]


@spread
def reproduce(
    running: Running,
    experiments: Experiments,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for tables, figures and the report.")] = Path(
        "reproduction"
    ),
    figures_only: Annotated[
        bool, typer.Option("--figures-only", help="Draw figures and report again from the tables of a finished run.")
    ] = False,
) -> None:
    """Run the paper's experiments, draw its figures, and say which of its claims hold."""
    from palpate.cli import reproducing

    if not figures_only:
        reproducing.run(reproducing.planned(experiments), output, running)
    reproducing.tell(output)
