"""Sections of the report about beliefs: how sure, and how right."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.experiments.comparison import calibration_findings
from palpate.experiments.comparison.plan import IN_MODEL
from palpate.experiments.comparison.results import Results
from palpate.experiments.comparison.sections import own_methods_of, settings_words
from palpate.markdown import Cell, table

__all__ = ["calibration_report", "numbers_section", "states_section"]


def states_section(results: Results) -> str:
    """Beliefs about categorical properties."""
    own = results.where(world=IN_MODEL)
    rows: list[list[Cell]] = []
    for name in own_methods_of(own):
        for step in (2, 5):
            part = own.where(method=name, step=step)
            for one in calibration_findings.states(part):
                brier = part.mean(part.numbers(f"{one.name}_brier"))
                figures = (one.cross_entropy_bits, one.entropy_bits, brier, one.accuracy, one.confidence, one.ece)
                rows.append([name, str(step), one.name, *figures])
    columns = ["method", "actions", "property", "cross-entropy [bits]", "entropy [bits]", "Brier", "accuracy"]
    shown = table([*columns, "confidence", "class-wise ECE"], rows)
    return f"""## Beliefs about states

In-model, after two and after all actions. A belief that is as sure as it is right has a cross-entropy near its
entropy and an accuracy near its confidence. The calibration error of a few hundred beliefs is above zero by
chance alone.

{shown}"""


def numbers_section(results: Results) -> str:
    """Beliefs about continuous properties."""
    own = results.where(world=IN_MODEL, step=5)
    rows: list[list[Cell]] = [
        [name, one.name, one.crps, one.within_50, one.within_90]
        for name in own_methods_of(own)
        for one in calibration_findings.numbers(own.where(method=name))
    ]
    shown = table(["method", "property", "CRPS", "in the 50 % interval", "in the 90 % interval"], rows)
    return f"## Beliefs about numbers\n\nIn-model, after all actions. CRPS in the property's unit.\n\n{shown}"


def calibration_report(results: Results, settings: Mapping[str, object]) -> str:
    """The report of a calibration: figures, and whether they are what they should be."""
    found = calibration_findings.checks(results)
    made = table(
        ["check", "found", "wanted", "verdict"],
        [[one.words, one.found, one.wanted, "holds" if one.holds else "does not hold"] for one in found],
        digits=4,
    )
    seen = table(
        ["property", "cross-entropy [bits]", "entropy [bits]", "accuracy", "confidence", "class-wise ECE"],
        [
            [s.name, s.cross_entropy_bits, s.entropy_bits, s.accuracy, s.confidence, s.ece]
            for s in calibration_findings.states(results)
        ],
    )
    return f"""# Calibration

Objects and outcomes drawn from the network that is believed, exact beliefs after all actions.
The tolerances are for 20 000 objects: fewer miss some of them by chance. Settings: {settings_words(settings)}.

{made}

{seen}
"""
