"""The report of a comparison, in Markdown: every section from the table of results alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from palpate.experiments.comparison import findings
from palpate.experiments.comparison.belief_sections import numbers_section, states_section
from palpate.experiments.comparison.cost_sections import gains_section, regret_section, stopping_section, target_section
from palpate.experiments.comparison.findings import p_words
from palpate.experiments.comparison.plan import IN_MODEL
from palpate.experiments.comparison.results import Results
from palpate.experiments.comparison.sections import METHOD_WORDS, methods_of, settings_words
from palpate.experiments.comparison.worlds import worlds
from palpate.experiments.measures import FLOOR
from palpate.experiments.statistics import Contrast
from palpate.markdown import Cell, table

__all__ = ["comparison_report"]

OBJECT_METHODS = ("exact-greedy", "actsel", "actsel-best-case")

CAUTION = """Objects and outcomes are simulated from the published tables, and the exact engine believes these
tables: that favours exact inference by construction. What is shown is what the methods make of the same
outcomes where the tables are right, and in the worlds that are not as believed where they are wrong in one
respect. No claim is made about a real robot."""


def comparison_report(results: Results, settings: Mapping[str, object]) -> str:
    """The report.

    Parameters
    ----------
    settings
        What was run, by name.
    """
    sections: tuple[Callable[[Results], str], ...] = (
        _primary,
        _learning,
        _secondary,
        states_section,
        numbers_section,
        target_section,
        regret_section,
        gains_section,
        stopping_section,
        _worlds,
        _objects,
    )
    head = f"# Comparison\n\n{CAUTION}\n\nSettings: {settings_words(settings)}."
    return "\n\n".join([head, *(section(results) for section in sections)]) + "\n"


def _primary(results: Results) -> str:
    first, beside = findings.primary(results)
    return f"""## Primary contrast

Fixed beforehand: world *in-model*, objective category and material together, cross-entropy of the truth,
mean of the two properties and of the steps 0 to 5, exact greedy less ACTSEL as released. Objects are the unit:
sign-flip permutation test, 95 % bootstrap interval over objects. Probabilities of the truth are floored at
{FLOOR:g}, which is {-np.log2(FLOOR):.2f} bits.

**{findings.verdict(first)}**

Beside it, against ACTSEL given C[o, :] / sum for a label, its best case: {findings.verdict(beside)}"""


def _learning(results: Results) -> str:
    own = results.where(world=IN_MODEL)
    curves = {name: own.where(method=name).curve("cross_entropy_bits").mean for name in methods_of(own)}
    steps = [str(step) for step in range(max(map(len, curves.values())))]
    rows: list[list[Cell]] = [
        [name, METHOD_WORDS[name], *curve, float(np.mean(curve))] for name, curve in curves.items()
    ]
    shown = table(["method", "what it is", *steps, "mean"], rows)
    return f"## Cross-entropy of the truth by number of actions [bits]\n\nIn-model.\n\n{shown}"


def _secondary(results: Results) -> str:
    shown = _contrasts(findings.secondary(results))
    return f"""## Better inference, or better choices

In-model, the same score as above. *actsel-scored-exact* are ACTSEL's choices with exact beliefs,
*greedy-scored-actsel* exact greedy's choices with ACTSEL's beliefs. p-values after Holm over this table.

{shown}"""


def _contrasts(found: Sequence[Contrast]) -> str:
    rows: list[list[Cell]] = []
    for one in found:
        p, after = p_words(one.p), p_words(one.adjusted_p or 0.0)
        rows.append([one.name, one.mean, f"{one.low:.3f} to {one.high:.3f}", p, after])
    return table(["contrast", "difference [bits]", "95 % interval", "p", "p after Holm"], rows)


def _worlds(results: Results) -> str:
    words = {world.name: world.words for world in worlds()}
    rows: list[list[Cell]] = []
    for world, (first, beside) in findings.under_changes(results).items():
        means = (
            np.mean(list(findings.mean_over_steps(results, world, m).values())) for m in ("exact-greedy", "actsel")
        )
        rows.append([world, words[world], *(float(mean) for mean in means), *_short(first), *_short(beside)])
    columns = ["world", "what it is", "exact-greedy", "actsel", "difference", "p after Holm"]
    shown = table([*columns, "difference from best case", "p after Holm"], rows)
    return f"""## Where the world is not as believed

Cross-entropy of the truth [bits], mean of the known properties and of the steps, with 95 % intervals of the
differences over objects; p-values after Holm over all of them.

{shown}"""


def _short(found: Contrast) -> tuple[str, str]:
    return f"{found.mean:.3f} ({found.low:.3f} to {found.high:.3f})", p_words(found.adjusted_p or 0.0)


def _objects(results: Results) -> str:
    own = results.where(world="objects")
    rows: list[list[Cell]] = []
    for name in methods_of(own):
        part = own.where(method=name)
        found = [part.where(trick=trick) for trick in (False, True)]
        at_end = [each.where(step=5) for each in found]
        figures = [each.mean(each.over_states("cross_entropy_bits")) for each in (*found, *at_end)]
        right = [100 * each.mean(each.over_states("correct")) for each in at_end]
        rows.append([name, *figures, *right])
    columns = ["method", "plain, mean of steps", "tricks, mean of steps", "plain, at the end", "tricks, at the end"]
    shown = table([*columns, "plain, right at the end [%]", "tricks, right at the end [%]"], rows)
    return f"""## The known objects

Cross-entropy of the truth [bits]. Tricks look like another object: actions that see the appearance are drawn for
that one. True properties that are stand-ins are not scored.

{shown}

Object by object, at the end. An object that is far from what the network believes of its kind, in volume for
instance, counts against a method in so far as the method takes its readings and the network at their word.

{_each_object(own.where(step=5))}"""


def _each_object(at_end: Results) -> str:
    names = [name for name in OBJECT_METHODS if name in methods_of(at_end)]
    parts = [at_end.where(method=name) for name in names]
    found = [part.by_object(part.over_states("cross_entropy_bits")) for part in parts]
    things = dict.fromkeys(thing for means in found for thing in means)
    return table(["object", *names], [[thing, *(means.get(thing) for means in found)] for thing in things])
