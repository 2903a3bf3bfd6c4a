"""The report of a reproduction in Markdown: the claims with their verdicts, the figures, how it was made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from palpate.experiments.engines import engine_words
from palpate.experiments.frames import Frame
from palpate.experiments.reproduction.claims import verdicts
from palpate.experiments.reproduction.paper import Paper
from palpate.experiments.reproduction.tasks import GREEDY, LEAST_GAIN_BITS, START
from palpate.experiments.reproduction.verdict import Verdict
from palpate.markdown import Markdown, table

__all__ = ["claims_table", "report"]

CAVEAT = (
    "Outcomes are simulated from the published tables, which is the world that exact inference believes in: it is "
    "favoured by construction, and nothing is claimed about real robots."
)


def report(steps: Frame, paper: Paper, pictures: Mapping[str, Path], settings: Mapping[str, object]) -> str:
    """The whole report.

    Parameters
    ----------
    pictures
        What each shows, to its file beside the report.
    settings
        Of the run, as its manifest holds them.
    """
    main, *others = steps.unique("network")
    own = steps.where(network=main)
    parts = ["# The paper's experiments, reproduced", _how(settings, main)]
    parts += ["## The paper's claims", claims_table(verdicts(own, paper.claims))]
    for network in others:
        found = verdicts(steps.where(network=network), paper.claims)
        parts += [f"## The claims with network `{network}`", claims_table(found)]
    parts += ["## Objective by objective", _objectives_table(own)]
    parts += ["## Figures", *(f"**{words}**\n\n![{words}]({path.name})" for words, path in pictures.items())]
    problems = settings.get("problems")
    if isinstance(problems, list) and problems:
        parts += ["## Recordings that are missing or broken", "\n".join(f"- {problem}" for problem in problems)]
    return "\n\n".join(parts) + "\n"


def claims_table(found: Sequence[Verdict]) -> str:
    """A row per claim: the verdict, and each engine's figure."""
    engines = list(dict.fromkeys(engine for verdict in found for engine in verdict.findings))
    header = ["Claim", "Verdict", *map(engine_words, engines)]
    rows = [
        [verdict.claim.text, Markdown(f"**{verdict.words}**"), *(_figure(verdict, engine) for engine in engines)]
        for verdict in found
    ]
    return table(header, rows)


def _figure(verdict: Verdict, engine: str) -> str:
    return verdict.findings[engine].figure if engine in verdict.findings else "not run"


def _how(settings: Mapping[str, object], network: str) -> str:
    recordings = settings["recordings"]
    source = f"drawn from the sensor models of `{network}`" if recordings is None else f"recorded, in `{recordings}`"
    objects, engines = settings["objects"], settings["engines"]
    assert isinstance(objects, list)
    assert isinstance(engines, list)
    parts = [
        f"{len(objects)} objects, {settings['repetitions']} repetitions each, by "
        f"{', '.join(map(engine_words, engines))}; outcomes are {source}, once for each object and repetition, and "
        f"every method sees the same. Seed {settings['seed']}, palpate {settings['palpate']}.",
        "Choices are for the largest expected gain, of several properties its sum. Exact arms stop when the best gain "
        f"is below {LEAST_GAIN_BITS} bits, ACTSEL when no gain is above zero; entropies and scores are of runs that "
        "go on.",
    ]
    return "\n\n".join(parts if recordings is not None else [*parts, CAVEAT])


def _objectives_table(steps: Frame) -> str:
    """Actions taken with stopping, and the entropy then and at the end, chosen and at random."""
    steps = steps.rows(steps["arm"] != START)
    header = ["Objective", "Engine", "Arm", "actions until it stops", "entropy then [bits]", "entropy after all [bits]"]
    rows = []
    for objective in steps.unique("objective"):
        for engine in steps.unique("engine"):
            for arm in steps.unique("arm"):
                own = steps.where(objective=objective, engine=engine, arm=arm)
                ends = own.rows(np.array([stop is not None for stop in own["stop"]], dtype=bool))
                last = own.where(step=max(own.unique("step")))
                figures = (ends["step"], ends["entropy_bits"], last["entropy_bits"])
                cells = [f"{np.mean(values.astype(float)):.2f}" for values in figures]
                rows.append([objective, engine_words(engine), "chosen" if arm == GREEDY else arm, *cells])
    return table(header, rows)
