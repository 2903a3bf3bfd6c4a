"""What `palpate benchmark` does: run with a bar, draw, and tell what was found in short."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from palpate import __version__
from palpate.cli import benchmarking_bench
from palpate.cli.benchmark_options import Compared
from palpate.cli.task_options import Running
from palpate.cli.tasks_view import run_shown
from palpate.cli.terminal import console
from palpate.errors import PalpateError
from palpate.experiments.comparison.belief_sections import calibration_report
from palpate.experiments.comparison.calibration_findings import checks
from palpate.experiments.comparison.findings import primary, verdict
from palpate.experiments.comparison.plan import FULL, QUICK, calibration_tasks, comparison_tasks
from palpate.experiments.comparison.report import comparison_report
from palpate.experiments.comparison.results import Results
from palpate.experiments.comparison.tables import RESULTS, read_results, save_results
from palpate.experiments.running import Task, settings_of
from palpate.figures.calibration import draw_calibration
from palpate.figures.comparison import draw_comparison
from palpate.network.digest import digest
from palpate.network.reading import load_network
from palpate.wording import plural

__all__ = ["check_together", "run", "tell"]

REPORT = "report.md"
CALIBRATION = "calibration"
MANY = 20_000


def check_together(asked: Compared) -> None:
    """Refuse options of the one kind of benchmark with the other."""
    drawn = {"--quick": asked.quick, "--calibration": asked.calibration, "--objects": asked.objects is not None}
    wrong = [name for name, given in drawn.items() if given] if asked.on_bench else []
    if wrong:
        raise PalpateError(
            f"{', '.join(wrong)}: for drawn objects, and --robot mujoco was found, expected one of the two"
        )
    if asked.repetitions is not None and not asked.on_bench:
        raise PalpateError("--repetitions: for the bench alone, expected --robot mujoco")


def run(asked: Compared, folder: Path, running: Running) -> None:
    """Run the tasks and save the table.

    Raises
    ------
    PalpateError
        A calibration was asked for that is quick: it has only one size.
    """
    if asked.on_bench:
        benchmarking_bench.run(asked, folder, running)
        return
    if asked.quick and asked.calibration:
        raise PalpateError("--quick is for the comparison, and --calibration was found, expected one of the two")
    run_shown(_tasks(asked), folder, running, doing="Comparing", settings=_settings(asked))
    save_results(folder)


def _tasks(asked: Compared) -> list[Task]:
    if asked.calibration:
        return calibration_tasks(_objects(asked), asked.seed, asked.network)
    size = QUICK if asked.quick else FULL
    return comparison_tasks(replace(size, in_model=_objects(asked)), asked.seed, asked.network)


def _objects(asked: Compared) -> int:
    """How many are drawn in the in-model world: a number that fits the kind of run where none was typed."""
    return asked.objects or (MANY if asked.calibration else (QUICK if asked.quick else FULL).in_model)


def _settings(asked: Compared) -> dict[str, object]:
    """All that the results depend on, as JSON."""
    network = load_network(asked.network)
    return {
        "kind": CALIBRATION if asked.calibration else "quick comparison" if asked.quick else "comparison",
        "objects": _objects(asked),
        "seed": asked.seed,
        "network": f"{network.name} {digest(network)}",
        "palpate": __version__,
    }


def tell(folder: Path) -> None:
    """Draw the figures, write the report, and print the main findings and where all is."""
    results, settings = read_results(folder), settings_of(folder)
    if settings.get("kind") == benchmarking_bench.KIND:
        benchmarking_bench.tell(folder)
        return
    if settings.get("kind") == CALIBRATION:
        draw_calibration(results, folder / "calibration.png")
        pictures = {"Probabilities against frequencies, and ranks of the truth": folder / "calibration.png"}
        text = calibration_report(results, settings)
        _print_checks(results)
    else:
        pictures = draw_comparison(results, folder)
        text = comparison_report(results, settings)
        first, beside = primary(results)
        print(f"Primary contrast: {verdict(first)}")
        print(f"Beside it: {verdict(beside)}")
    shown = "\n\n".join(f"**{words}**\n\n![{words}]({path.name})" for words, path in pictures.items())
    (folder / REPORT).write_text(f"{text}\n## Figures\n\n{shown}\n", encoding="utf-8")
    print(f"{folder / REPORT}: all of it, with {plural(len(pictures), 'figure')}; {RESULTS} beside it is the table")


def _print_checks(results: Results) -> None:
    from rich.table import Table

    table = Table("Check", "Found", "Wanted", "Verdict", box=None)
    for one in checks(results):
        table.add_row(one.words, f"{one.found:.4f}", one.wanted, "holds" if one.holds else "does not hold")
    console().print(table)
    if len(results) < MANY:
        print(f"The tolerances are for {MANY} objects: {len(results)} miss some of them by chance.")
