"""`palpate benchmark`: exact inference, the paper's method and chance on the same outcomes; or the bench in physics."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.benchmark_options import Compared
from palpate.cli.spreading import spread
from palpate.cli.task_options import Running

__all__ = ["benchmark"]


@spread
def benchmark(
    running: Running,
    compared: Compared,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for the table, figures and the report.")
    ] = Path("benchmark"),
    figures_only: Annotated[
        bool, typer.Option("--figures-only", help="Draw figures and report again from the table of a finished run.")
    ] = False,
) -> None:
    """Compare exact inference, the paper's method and chance on the same simulated outcomes."""
    from palpate.cli import benchmarking

    benchmarking.check_together(compared)
    if not figures_only:
        benchmarking.run(compared, output, running)
    benchmarking.tell(output)
