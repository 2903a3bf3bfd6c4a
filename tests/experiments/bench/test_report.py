"""The report on the bench, and its figure, from rows alone."""

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from palpate.experiments.bench.held_out import CALIBRATED, held_out_tasks
from palpate.experiments.bench.report import bench_contrasts, bench_report
from palpate.experiments.comparison.results import Results
from palpate.figures.bench import draw_bench
from tests.experiments.bench.made_up import NETWORK, THINGS, measured


@cache
def results() -> Results:
    tasks = [task for task in held_out_tasks(NETWORK, measured()) if getattr(task, "thing", "") in THINGS]
    parts = [pa.Table.from_pylist(task.run()) for task in tasks]
    return Results.read(pa.concat_tables(parts, promote_options="permissive"))


def test_the_report_has_every_section() -> None:
    """Curves, contrasts, objects, pairs and sensors, with every object and action in it."""
    text = bench_report(results(), {"seed": 1}).replace("\\", "")
    for part in ("by number of actions", "What makes a difference", "Object by object", "Pairs", "held out", "seed 1"):
        assert part in text
    assert all(thing in text for thing in THINGS)
    assert all(action in text for action in NETWORK.actions)
    assert not re.search(r"\bnan\b", text)


def test_the_curve_is_the_mean_over_objects() -> None:
    """The figure in the table is that of the rows, by hand."""
    own = results().where(world=CALIBRATED, method="exact-greedy", step=5)
    means = []
    for thing in THINGS:
        part = own.where(object=thing)
        known = [part.numbers(f"{name}_cross_entropy_bits") for name in ("category", "material")]
        means.append(np.nanmean([np.nanmean(values) for values in known if not np.isnan(values).all()]))
    shown = next(line for line in bench_report(results(), {}).splitlines() if line.startswith("| greedy, calibrated |"))
    assert float(shown.split(" | ")[-2]) == pytest.approx(float(np.mean(means)), abs=6e-4)


def test_the_contrasts_are_against_the_first_arm() -> None:
    """Three of them, each over all objects, adjusted together."""
    found = bench_contrasts(results())
    assert [one.objects for one in found] == [len(THINGS)] * 3
    assert all(one.name.startswith("greedy, calibrated less ") for one in found)
    assert all(one.adjusted_p is not None and one.adjusted_p >= one.p and math.isfinite(one.mean) for one in found)


def test_the_figure_is_drawn(tmp_path: Path) -> None:
    """A picture of some size."""
    draw_bench(results(), tmp_path / "bench.png")
    assert (tmp_path / "bench.png").stat().st_size > 20_000
