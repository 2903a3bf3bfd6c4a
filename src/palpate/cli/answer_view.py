"""The answer of `palpate infer` as tables for people."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.cli.answer import Inferred
from palpate.cli.belief_view import belief_table, plain_table, scales
from palpate.evidence import spell_out
from palpate.inference.belief import Belief
from palpate.wording import number, outcome_words

__all__ = ["answer_tables", "gain_matrix"]


def answer_tables(inferred: Inferred) -> RenderableType:
    """Evidence with its surprise, belief, and gain of every action about every property."""
    belief = inferred.belief
    evidence = plain_table("evidence", "outcome", "surprise", right=(2,))
    for observation, surprise in zip(belief.evidence, inferred.surprises, strict=True):
        returned = outcome_words(spell_out(belief.network, observation.action, observation.outcome))
        evidence.add_row(Text(observation.action, style="bold"), returned, number(surprise, 2))
    total = Text(f"log evidence {number(inferred.log_evidence_bits, 4)} bits", style="dim")
    parts: list[RenderableType] = [evidence, total, Text()] if belief.evidence else []
    return Group(*parts, belief_table(belief, scales(inferred.prior)), Text(), gain_matrix(belief))


def gain_matrix(belief: Belief) -> Table:
    """Expected gain of every action about every property and everything [bits]."""
    gains = belief.expected_gains()
    objectives = [str(objective) for objective in next(iter(gains.values()), {})]
    table = plain_table("bits about", *gains, right=tuple(range(1, len(gains) + 1)))
    for objective in objectives:
        cells = [gains[action][objective] for action in gains]
        best = max((gain for gain in cells if gain is not None), default=0.0)
        shown = [Text("-" if g is None else f"{g:.3f}", style="bold" if g == best and g else "") for g in cells]
        table.add_row(Text(objective, style="bold"), *shown)
    return table
