"""Whether the truth about a known object was found."""

from __future__ import annotations

from rich.table import Table
from rich.text import Text

from palpate.cli.belief_view import plain_table
from palpate.inference.belief import Belief
from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.message_passing.marginals import UnsaidMarginal
from palpate.network.model import KnownObject, TrueValue
from palpate.wording import number

__all__ = ["truth_table"]


def truth_table(belief: Belief, known: KnownObject) -> Table:
    """The true properties of the object beside what is believed.

    A state counts as found where it is the most probable one, a number where it lies in the 90 %
    interval. A truth marked as unknown is a stand-in for simulation and is not scored.
    """
    table = plain_table("truth", "is", "", "verdict")
    for name in belief.network.properties:
        if name in known.truth:
            true = known.truth[name]
            unit = getattr(belief.network.property(name), "unit", "")
            shown = true.value if isinstance(true.value, str) else f"{number(true.value)} {unit}"
            table.add_row(Text(name, style="bold"), shown, Text(true.status, style="dim"), _verdict(belief, name, true))
    return table


def _verdict(belief: Belief, name: str, true: TrueValue) -> Text:
    if not true.scored:
        return Text("not scored", style="dim")
    marginal = belief.marginal(name)
    if isinstance(marginal, UnsaidMarginal):
        return Text("not said by this engine", style="dim")
    if isinstance(marginal, ContinuousMarginal):
        inside = marginal.quantile(0.05) <= float(true.value) <= marginal.quantile(0.95)
        return _mark(inside, "inside the 90 % interval" if inside else "outside the 90 % interval")
    believed = dict(zip(marginal.states, marginal.probabilities.tolist(), strict=True))
    best = max(believed, key=lambda state: believed[state])
    p_true = f"P = {believed[str(true.value)]:.3f}"
    return _mark(best == true.value, f"found, {p_true}" if best == true.value else f"not found, {p_true}")


def _mark(found: bool, words: str) -> Text:
    return Text(f"{'✓' if found else '✗'} {words}", style="green" if found else "yellow")
