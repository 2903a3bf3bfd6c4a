"""The report on the bench, in Markdown: every section from the table of results alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.experiments.bench.held_out import CALIBRATED, GREEDY, PUBLISHED, SENSORS, TOLD
from palpate.experiments.bench.pairs import PAIRS
from palpate.experiments.comparison.findings import mean_over_steps, p_words
from palpate.experiments.comparison.methods import RANDOM
from palpate.experiments.comparison.results import Results
from palpate.experiments.comparison.sections import settings_words
from palpate.experiments.statistics import Contrast, adjusted, contrast
from palpate.markdown import Cell, table

__all__ = ["MOST_BITS", "bench_contrasts", "bench_report"]

WORLDS = {
    CALIBRATED: "labels and readings, sensors calibrated on the other objects",
    PUBLISHED: "the same, sensors as the network has them",
    TOLD: "vectors and SDs as the estimators tell them, calibrated sensors choose",
}
METHODS = {GREEDY.name: "greedy", RANDOM.name: "random"}
MOST_BITS = 20.0
"""More than so many bits are certainty, and count as so many."""


def bench_report(results: Results, settings: Mapping[str, object]) -> str:
    """The report.

    Parameters
    ----------
    settings
        What was run, by name.
    """
    head = f"""# The known objects on the bench

Each object is explored with sensors that were calibrated on all others: what each action gave was measured once, so
that all methods see the same. Priors are those of the network. Settings: {settings_words(settings)}."""
    sections = (_learning, _contrasts, _objects, _pairs, _sensors)
    return "\n\n".join([head, *(section(results) for section in sections)]) + "\n"


def bench_contrasts(results: Results) -> list[Contrast]:
    """What is asked: chosen against random actions, and calibrated against other sensors; p-values after Holm."""
    arms = [(CALIBRATED, GREEDY.name), (CALIBRATED, RANDOM.name), (PUBLISHED, GREEDY.name), (TOLD, GREEDY.name)]
    names = {arm: f"{METHODS[arm[1]]}, {arm[0]}" for arm in arms}
    first, means = arms[0], {arm: mean_over_steps(results, *arm) for arm in arms}
    return adjusted([contrast(f"{names[first]} less {names[arm]}", means[first], means[arm]) for arm in arms[1:]])


def _learning(results: Results) -> str:
    rows: list[list[Cell]] = []
    steps: tuple[int, ...] = ()
    for world, words in WORLDS.items():
        for name, short in METHODS.items():
            curve = results.where(world=world, method=name).curve("cross_entropy_bits")
            steps = curve.steps
            rows.append([f"{short}, {world}", words, *curve.mean, float(np.mean(curve.mean))])
    shown = table(["actions", "evidence", *(str(step) for step in steps), "mean"], rows)
    each = [_by_property(results, name) for name in results.categorical]
    return f"""## Cross-entropy of the truth by number of actions [bits]

Mean of the categorical properties and over objects; random is the mean of all orders.

{shown}

{table(["property", "actions", *(str(step) for step in steps)], [row for rows in each for row in rows])}"""


def _by_property(results: Results, name: str) -> list[list[Cell]]:
    found: list[list[Cell]] = []
    for method, words in METHODS.items():
        own = results.where(world=CALIBRATED, method=method)
        found.append([name, f"{words}, {CALIBRATED}", *own.curve(f"{name}_cross_entropy_bits").mean])
    return found


def _contrasts(results: Results) -> str:
    rows: list[list[Cell]] = [
        [one.name, one.mean, f"{one.low:.3f} to {one.high:.3f}", p_words(one.adjusted_p or 0.0), one.objects]
        for one in bench_contrasts(results)
    ]
    shown = table(["contrast", "difference [bits]", "95 % interval", "p after Holm", "objects"], rows)
    return f"## What makes a difference\n\nMean of all steps; objects are the unit.\n\n{shown}"


def _objects(results: Results) -> str:
    last = max(results.where(world=CALIBRATED).numbers("step"))
    own = results.where(world=CALIBRATED, method=GREEDY.name, step=last)
    rows: list[list[Cell]] = []
    for thing in own.distinct("object"):
        part = own.where(object=thing)
        rows.append([thing, *(_mean(part.numbers(f"{name}_cross_entropy_bits")) for name in own.categorical)])
    shown = table(["object", *own.categorical], rows)
    return f"## Object by object, after all actions [bits]\n\nStand-ins in the truth are not scored.\n\n{shown}"


def _pairs(results: Results) -> str:
    own = results.where(world=PAIRS)
    rows: list[list[Cell]] = []
    for thing in own.distinct("object"):
        part = own.where(object=thing)
        by_action = ", ".join(_words(part, action) for action in part.distinct("used"))
        right = 100 * np.mean(list(_right(part).values()))
        rows.append([thing, f"{right:.0f} %", by_action, *_revealing(part)])
    columns = ["object", "told apart", "bits for the right one of the pair", "least surprise", "when"]
    return f"""## Pairs that look alike

Explored by gain per cost, so that the robot looks before it touches. An object is told apart where its outcomes
together are more probable of it than of the one that it looks like, or that looks like it. Bits by action are medians,
of at most {MOST_BITS:g}; actions whose truth is the same, or not known, say nothing. Least surprise: the median over
repetitions of the smallest probability of an outcome at least as unlikely, and the step and action at which it was
most often the smallest.

{table(columns, rows)}"""


def _words(part: Results, action: str) -> str:
    bits = np.clip(part.where(used=action).numbers("pair_bits"), -MOST_BITS, MOST_BITS)
    return f"{action} {float(np.median(bits)) + 0.0:.1f}"


def _right(part: Results) -> dict[float, float]:
    """By repetition, 1 where all outcomes together are for the right object, a half where they say nothing."""
    repetition, bits = part.numbers("repetition"), part.numbers("pair_bits")
    totals = {key: float(bits[repetition == key].sum()) for key in np.unique(repetition).tolist()}
    return {key: 0.5 * (1 + np.sign(total)) for key, total in totals.items()}


def _revealing(part: Results) -> tuple[float, str]:
    repetition, surprise = part.numbers("repetition"), part.numbers("surprise")
    least, where = [], []
    for key in np.unique(repetition).tolist():
        own = part.where(repetition=key)
        values = own.numbers("surprise")
        if not np.isnan(values).all():
            place = int(np.nanargmin(values))
            least.append(float(values[place]))
            where.append(f"{own.numbers('step')[place]:.0f}, {own.texts('used')[place]}")
    assert len(surprise) == len(repetition)
    return float(np.median(least)), max(sorted(set(where)), key=where.count)


def _sensors(results: Results) -> str:
    own = results.where(world=SENSORS)
    rows: list[list[Cell]] = []
    for action in own.distinct("method"):
        part = own.where(method=action)
        found = contrast(
            action, part.by_object(part.numbers("calibrated_log2_p")), part.by_object(part.numbers("published_log2_p"))
        )
        mean = part.mean(part.numbers("calibrated_log2_p"))
        rows.append([action, mean, found.mean, f"{found.low:.2f} to {found.high:.2f}", found.objects])
    columns = ["sensor", "log2 p", "better than published by", "95 % interval", "objects"]
    return f"""## Sensors on the object that was held out

log2 of the probability, or density, of a reading given the truth [bits].

{table(columns, rows)}"""


def _mean(values: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float | None:
    return None if np.isnan(values).all() else float(np.nanmean(values))
