"""The paper's four figures, drawn from the tables of a reproduction alone."""

from __future__ import annotations

from pathlib import Path

from palpate.experiments.engines import engine_words
from palpate.experiments.frames import Frame
from palpate.experiments.reproduction.paper import Paper
from palpate.experiments.reproduction.tasks import GREEDY, RANDOM, START
from palpate.figures.action_counts import draw_action_counts
from palpate.figures.case_studies import draw_case_studies
from palpate.figures.paired_curves import Quantity, draw_curves
from palpate.figures.palette import action_colours

__all__ = ["draw_reproduction"]

ARMS = {GREEDY: "chosen actions", RANDOM: "random actions"}


def draw_reproduction(steps: Frame, beliefs: Frame, paper: Paper, folder: Path) -> dict[str, Path]:
    """Draw what the tables of one network hold of the paper's figures.

    Parameters
    ----------
    folder
        Where the pictures go; it exists.

    Returns
    -------
    dict
        What a picture shows, to its file.
    """
    steps = steps.rows(steps["arm"] != START)
    objectives = set(steps.unique("objective"))
    actions = [name.removeprefix("gain_").removesuffix("_bits") for name in steps.names if name.startswith("gain_")]
    colours = action_colours(actions)
    engines = {engine_words(engine): steps.where(engine=engine) for engine in steps.unique("engine")}
    chosen = {words: own.where(arm=GREEDY) for words, own in engines.items()}
    pictures: dict[str, Path] = {}
    cases = _cases(steps, paper)
    for engine in steps.unique("engine") if cases else ():
        words = engine_words(engine)
        path = pictures[f"Case studies, {words}"] = folder / f"case_studies_{engine}.png"
        draw_case_studies(words, chosen[words], beliefs.where(engine=engine), cases, colours, path)
    counted = [name for name in paper.figure_actions if name in objectives]
    if counted:
        path = pictures["Actions at each step, with stopping"] = folder / "actions.png"
        draw_action_counts(chosen, counted, colours, path)
    if paper.figure_entropy in objectives:
        path = pictures[f"Entropy of {paper.figure_entropy}"] = folder / "entropy.png"
        quantity = Quantity(paper.figure_entropy, "entropy_bits", "entropy [bits]")
        draw_curves(engines, [quantity], ARMS, path)
    scored = [name for name in paper.figure_cross_entropy if name in objectives]
    if scored:
        path = pictures[f"Cross-entropy of {' and of '.join(scored)}"] = folder / "cross_entropy.png"
        quantities = [Quantity(name, f"cross_entropy_{name}_bits", "cross-entropy [bits]") for name in scored]
        draw_curves(engines, quantities, ARMS, path)
    return pictures


def _cases(steps: Frame, paper: Paper) -> list[tuple[str, str, str]]:
    """The case studies that the table holds, with the property shown."""
    objects, objectives = set(steps.unique("object")), set(steps.unique("objective"))
    return [
        (case.object, case.objective, paper.objectives[case.objective][0])
        for case in paper.cases
        if case.object in objects and case.objective in objectives
    ]
