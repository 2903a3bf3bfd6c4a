"""What `palpate benchmark` does: run with a bar, draw, and tell what was found in short."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from palpate import __version__
from palpate.cli import benchmarking_bench
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
from palpate.experiments.comparison.worlds import NETWORK
from palpate.experiments.running import Task, settings_of
from palpate.figures.calibration import draw_calibration
from palpate.figures.comparison import draw_comparison
from palpate.figures.wording import plural
from palpate.network.digest import digest
from palpate.network.reading import load_network

__all__ = ["Asked", "check_together", "run", "tell"]

REPORT = "report.md"
CALIBRATION = "calibration"
MANY = 20_000


@dataclass(frozen=True)
class Asked:
    """What was asked for.

    Parameters
    ----------
    objects
        Drawn in the in-model world; a number that fits the kind of run where None.
    """

    quick: bool
    calibration: bool
    objects: int | None
    seed: int
    network: str = NETWORK

    @property
    def tasks(self) -> list[Task]:
        """What is run for it."""
        if self.calibration:
            return calibration_tasks(self.objects or MANY, self.seed, self.network)
        size = QUICK if self.quick else FULL
        return comparison_tasks(replace(size, in_model=self.objects or size.in_model), self.seed, self.network)

    @property
    def settings(self) -> dict[str, object]:
        """All that the results depend on, as JSON."""
        kind = CALIBRATION if self.calibration else "quick comparison" if self.quick else "comparison"
        network = load_network(self.network)
        return {
            "kind": kind,
            "objects": self.objects or (MANY if self.calibration else (QUICK if self.quick else FULL).in_model),
            "seed": self.seed,
            "network": f"{network.name} {digest(network)}",
            "palpate": __version__,
        }


def check_together(bench: bool, quick: bool, calibration: bool, objects: int | None, repetitions: int | None) -> None:
    """Refuse options of the one kind of benchmark with the other."""
    drawn = {"--quick": quick, "--calibration": calibration, "--objects": objects is not None}
    wrong = [name for name, given in drawn.items() if given] if bench else []
    if wrong:
        raise PalpateError(
            f"{', '.join(wrong)}: for drawn objects, and --robot mujoco was found, expected one of the two"
        )
    if repetitions is not None and not bench:
        raise PalpateError("--repetitions: for the bench alone, expected --robot mujoco")


def run(asked: Asked, folder: Path, *, workers: int | None, scheduler: str | None, resume: bool) -> None:
    """Run the tasks and save the table.

    Raises
    ------
    PalpateError
        A calibration was asked for that is quick: it has only one size.
    """
    if asked.quick and asked.calibration:
        raise PalpateError("--quick is for the comparison, and --calibration was found, expected one of the two")
    run_shown(
        asked.tasks,
        folder,
        doing="Comparing",
        settings=asked.settings,
        workers=workers,
        scheduler=scheduler,
        resume=resume,
    )
    save_results(folder)


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
