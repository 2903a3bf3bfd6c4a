"""What `palpate benchmark --robot mujoco` does: objects measured with a bar, explored, drawn, and told in short."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate import __version__
from palpate.cli.benching import check_installed
from palpate.cli.tasks_view import run_shown
from palpate.errors import PalpateError
from palpate.experiments.bench.held_out import held_out_tasks
from palpate.experiments.bench.report import bench_contrasts, bench_report
from palpate.experiments.comparison.findings import verdict
from palpate.experiments.comparison.tables import RESULTS, read_results, save_results
from palpate.experiments.measuring import InPhysics, measure_tasks, measurements
from palpate.experiments.running import settings_of
from palpate.experiments.shared import SharedNetwork
from palpate.figures.bench import draw_bench
from palpate.network.digest import digest
from palpate.network.model import Network
from palpate.network.reading import load_network

__all__ = ["KIND", "run", "tell"]

KIND = "bench"
REPORT, PICTURE, OUTCOMES = "report.md", "bench.png", "outcomes"


@dataclass(frozen=True)
class _How:
    """How tasks are run."""

    workers: int | None
    scheduler: str | None
    resume: bool


def run(
    network: str,
    repetitions: int,
    seed: int,
    folder: Path,
    *,
    workers: int | None,
    scheduler: str | None,
    resume: bool,
) -> None:
    """Measure all objects, explore each with sensors calibrated on the others, and save the table."""
    check_installed()
    known, how = load_network(network), _How(workers, scheduler, resume)
    if len(known.objects) < 3:
        raise PalpateError(f"{network}: found {len(known.objects)} known objects, expected 3 at least to hold one out")
    from palpate.robots.mujoco.reading import bench_object

    for thing in known.objects:
        bench_object(known, thing)
    settings: dict[str, object] = {
        "kind": KIND,
        "network": f"{known.name} {digest(known)}",
        "repetitions": repetitions,
        "seed": seed,
        "palpate": __version__,
    }
    _measure(known, repetitions, seed, folder / OUTCOMES, settings, how)
    _explore(known, folder, settings, how)
    save_results(folder)


def _measure(known: Network, repetitions: int, seed: int, folder: Path, settings: dict[str, object], how: _How) -> None:
    lab = InPhysics(SharedNetwork(known))
    run_shown(
        measure_tasks(lab, list(known.objects), times=repetitions, seed=seed),
        folder,
        doing="Measuring",
        settings=settings,
        workers=how.workers,
        scheduler=how.scheduler,
        resume=how.resume,
    )


def _explore(known: Network, folder: Path, settings: dict[str, object], how: _How) -> None:
    run_shown(
        held_out_tasks(known, list(measurements(folder / OUTCOMES))),
        folder,
        doing="Exploring",
        settings=settings,
        workers=how.workers,
        scheduler=how.scheduler,
        resume=how.resume,
    )


def tell(folder: Path) -> None:
    """Draw the figure, write the report, and print the contrasts and where all is."""
    results = read_results(folder)
    draw_bench(results, folder / PICTURE)
    words = "What is learned by number of actions, and what was surprising about look-alikes"
    text = f"{bench_report(results, settings_of(folder))}\n## Figure\n\n![{words}]({PICTURE})\n"
    (folder / REPORT).write_text(text, encoding="utf-8")
    for found in bench_contrasts(results):
        print(verdict(found))
    print(f"{folder / REPORT}: all of it, with a figure; {RESULTS} beside it is the table")
