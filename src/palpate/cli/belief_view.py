"""A belief as a table for the terminal; legible without colour."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rich.bar import Bar
from rich.table import Table
from rich.text import Text

from palpate.inference.belief import Belief
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.inference.message_passing.marginals import UnsaidMarginal
from palpate.wording import number, plural

__all__ = ["Scale", "belief_table", "bits_bar", "plain_table", "scales"]

STATES_SHOWN = 3
LEAST_SHOWN = 0.005
WIDTH = 16


@dataclass(frozen=True)
class Scale:
    """The range of a continuous property that its interval is drawn on, in its unit."""

    low: float
    high: float

    def cell(self, value: float) -> int:
        """The character cell of a value, at the edge where it lies beyond."""
        share = (value - self.low) / (self.high - self.low) if self.high > self.low else 0.5
        return min(WIDTH - 1, max(0, int(share * WIDTH)))


def scales(prior: Belief) -> dict[str, Scale]:
    """The range of every number under the prior, from its 1 % to its 99 % quantile."""
    marginals = [prior.marginal(name) for name in prior.network.properties]
    numbers = [m for m in marginals if isinstance(m, ContinuousMarginal) and not isinstance(m, UnsaidMarginal)]
    return {m.name: Scale(m.quantile(0.01), m.quantile(0.99)) for m in numbers}


def plain_table(*headings: str, right: tuple[int, ...] = ()) -> Table:
    """A table without lines, as every table of the command line is."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    for index, heading in enumerate(headings):
        table.add_column(heading, justify="right" if index in right else "left")
    return table


def bits_bar(share: float, *, strong: bool = True) -> Bar:
    """A horizontal bar for a number between 0 and 1."""
    return Bar(1, 0, max(0.0, min(1.0, share)), width=WIDTH, color="cyan" if strong else "bright_black")


def belief_table(belief: Belief, drawn_on: Mapping[str, Scale]) -> Table:
    """What is believed about every property: the top states, or mean, SD and 90 % interval."""
    table = plain_table("belief", "state, or mean ± SD", "p, or 90 %", "", right=(2,))
    # the same widths from step to step, so that the eye finds its place again
    table.columns[1].min_width, table.columns[2].min_width = 20, 14
    for name in belief.network.properties:
        marginal = belief.marginal(name)
        if isinstance(marginal, UnsaidMarginal):
            table.add_row(Text(name, style="bold"), Text("not said by this engine", style="dim"))
        elif isinstance(marginal, ContinuousMarginal):
            _add_number(table, marginal, drawn_on[name])
        else:
            _add_states(table, marginal)
    return table


def _add_states(table: Table, marginal: CategoricalMarginal) -> None:
    """A row per likely state, and one for all others together."""
    # rounded, so that states as likely as each other stay in the network's order
    ranked = sorted(
        zip(marginal.states, marginal.probabilities.tolist(), strict=True), key=lambda item: -round(item[1], 9)
    )
    kept = 1 + sum(p >= LEAST_SHOWN for _, p in ranked[1:STATES_SHOWN])
    heading = Text(marginal.name, style="bold")
    for state, p in ranked[:kept]:
        table.add_row(heading, state, f"{p:.3f}", bits_bar(p, strong=p == ranked[0][1]))
        heading = Text()
    rest = ranked[kept:]
    if rest:
        total = sum(p for _, p in rest)
        table.add_row("", Text(plural(len(rest), "other"), style="dim"), f"{total:.3f}", bits_bar(total, strong=False))


def _add_number(table: Table, marginal: ContinuousMarginal, scale: Scale) -> None:
    low, middle, high = (marginal.quantile(p) for p in (0.05, 0.5, 0.95))
    spread = f"{number(marginal.mean)} ± {number(marginal.sd, 2)} {marginal.unit}"
    cells = ["·"] * WIDTH
    first, last = scale.cell(low), scale.cell(high)
    cells[first : last + 1] = ["━"] * (last + 1 - first)
    cells[scale.cell(middle)] = "●"
    interval = Text("".join(cells), style="bright_black")
    interval.stylize("cyan", first, last + 1)
    table.add_row(Text(marginal.name, style="bold"), spread, f"{number(low)} to {number(high)}", interval)
