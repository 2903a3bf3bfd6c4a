"""What `palpate benchmark --robot mujoco` does: objects measured with a bar, explored, drawn, and told in short."""

from __future__ import annotations

from pathlib import Path

from palpate import __version__
from palpate.cli.benching import check_installed
from palpate.cli.benchmark_options import Compared
from palpate.cli.task_options import Running
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
REPETITIONS = 10
REPORT, PICTURE, OUTCOMES = "report.md", "bench.png", "outcomes"


def run(asked: Compared, folder: Path, running: Running) -> None:
    """Measure all objects, explore each with sensors calibrated on the others, and save the table."""
    check_installed()
    known = _known(asked.network)
    settings: dict[str, object] = {
        "kind": KIND,
        "network": f"{known.name} {digest(known)}",
        "repetitions": asked.repetitions or REPETITIONS,
        "seed": asked.seed,
        "palpate": __version__,
    }
    measuring = measure_tasks(
        InPhysics(SharedNetwork(known)),
        list(known.objects),
        times=asked.repetitions or REPETITIONS,
        seed=asked.seed,
    )
    run_shown(measuring, folder / OUTCOMES, running, doing="Measuring", settings=settings)
    exploring = held_out_tasks(known, list(measurements(folder / OUTCOMES)))
    run_shown(exploring, folder, running, doing="Exploring", settings=settings)
    save_results(folder)


def _known(name: str) -> Network:
    """The network, whose objects can all be put on the bench."""
    from palpate.robots.mujoco.reading import bench_object

    known = load_network(name)
    if len(known.objects) < 3:
        raise PalpateError(f"{name}: found {len(known.objects)} known objects, expected 3 at least to hold one out")
    for thing in known.objects:
        bench_object(known, thing)
    return known


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
