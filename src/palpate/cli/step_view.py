"""A step of an exploration, and its end, for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.padding import Padding
from rich.rule import Rule
from rich.spinner import Spinner
from rich.table import Table
from rich.text import Text

from palpate.cli.belief_view import Scale, belief_table, bits_bar, plain_table
from palpate.cli.surprise import SURPRISING, impossible
from palpate.explore import Step
from palpate.inference.belief import Belief
from palpate.network.model import Network
from palpate.outcomes import Outcome
from palpate.selection.policies import Choice
from palpate.wording import number, outcome_words, plural

__all__ = ["View"]

GAP = 3


@dataclass(frozen=True)
class _Beside:
    """Gains with what was learnt, and the belief: side by side where there is room, else one above the other."""

    gains: Table
    learned: RenderableType
    belief: Table

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Lay the parts out for the width there is."""
        left, right = (console.measure(table, options=options).maximum for table in (self.gains, self.belief))
        if left + GAP + right > options.max_width:
            yield from (self.gains, Text(), self.learned, Text(), self.belief)
            return
        grid = Table.grid(padding=(0, GAP, 0, 0))
        grid.add_column(width=left)
        grid.add_row(Group(self.gains, Text(), self.learned), self.belief)
        yield grid


@dataclass(frozen=True)
class View:
    """How the steps of one exploration are shown.

    Parameters
    ----------
    objective
        Its name, as a heading.
    costs_s
        Cost of every action [s].
    drawn_on
        The scale of every number (`palpate.cli.belief_view.scales`).
    full_bits
        The gain that fills a bar: the best one before the first step [bits].
    """

    network: Network
    objective: str
    costs_s: Mapping[str, float]
    drawn_on: Mapping[str, Scale]
    full_bits: float
    verbose: bool = False

    def step(self, step: Step) -> RenderableType:
        """One step: the gains there were, the action and its outcome, the belief after it."""
        assert step.action is not None
        assert step.outcome is not None
        returned = self._returned(step.action, step.outcome)
        title = Text.assemble(f"Step {step.index}  ", (step.action, "bold cyan"), "  returned  ", (returned, "bold"))
        body = _Beside(self.gains(step.gains_bits, step.action), self._learned(step), self.belief(step.after))
        warning = impossible(step.surprise)
        suspected = [Text(), Text(warning, style="bold red")] if warning else []
        parts = [body, *suspected, *self._notes(step.notices)]
        return Group(Rule(title, align="left", style="dim"), Padding(Group(*parts), (0, 0, 1, 1)))

    def pending(self, choice: Choice, action: str) -> RenderableType:
        """A step while its action is being done."""
        title = Spinner("dots", f"Step {len(choice.taken) + 1}  {action} ... ({self.costs_s[action]:g} s)")
        return Group(
            title, Padding(_Beside(self.gains(choice.gains, action), "", self.belief(choice.belief)), (0, 0, 1, 1))
        )

    def end(self, last: Step, steps: Sequence[Step]) -> RenderableType:
        """Why exploration stopped, what was left to gain, and all steps in short."""
        # Below the rule, where a long reason wraps instead of being cut off.
        reason = Padding(Text(str(last.stop), style="bold"), (0, 0, 0, 1))
        parts: list[RenderableType] = [Rule("Stopped", align="left", style="dim"), reason]
        if last.gains_bits:
            parts += [Padding(self.gains(last.gains_bits, None), (0, 0, 1, 1))]
        if steps:
            parts += [Padding(self._history(steps), (0, 0, 1, 1))]
        return Group(*parts)

    def belief(self, belief: Belief) -> Table:
        """The belief about every property."""
        return belief_table(belief, self.drawn_on)

    def gains(self, gains_bits: Mapping[str, float], chosen: str | None) -> Table:
        """The expected gain of every action, the chosen one marked."""
        table = plain_table(f"gain on {self.objective}", "bits", "cost", "", right=(1, 2))
        for action, gain in gains_bits.items():
            is_chosen = action == chosen
            name = Text(f"{'▸' if is_chosen else ' '} {action}", style="bold cyan" if is_chosen else "")
            bar = bits_bar(gain / self.full_bits if self.full_bits > 0 else 0.0, strong=is_chosen)
            table.add_row(name, f"{gain:.3f}", f"{self.costs_s[action]:g} s", bar)
        return table

    def _returned(self, action: str, outcome: Outcome) -> str:
        measured = self.network.property(self.network.action(action).sensor.property)
        return outcome_words(outcome, getattr(measured, "unit", ""))

    def _learned(self, step: Step) -> RenderableType:
        """Gains expected and realised, surprise and cost."""
        lines = [Text(f"gain {_bits(step.expected_gain_bits)} expected, {_bits(step.realised_gain_bits)} realised")]
        if step.entropy_drop_bits is not None:
            lines.append(Text(f"entropy drop {step.entropy_drop_bits:.3f}"))
        cost = f"cost {step.cost_s:g} s, {step.total_cost_s:g} s so far"
        return Group(*lines, _surprise(step.surprise), Text(cost))

    def _notes(self, notices: Sequence[str]) -> list[RenderableType]:
        """What was decided in reading the outcome, or that something was."""
        if self.verbose:
            return [Text(), *(Text(f"note: {notice}", style="dim") for notice in notices)] if notices else []
        told = f"{plural(len(notices), 'note')} on how the outcome was read (--verbose)"
        return [Text(), Text(told, style="dim")] if notices else []

    def _history(self, steps: Sequence[Step]) -> Table:
        table = plain_table("step", "action", "outcome", "expected", "realised", "surprise", "time", right=(3, 4, 5, 6))
        for step in steps:
            if step.action is None or step.outcome is None:
                continue
            table.add_row(
                str(step.index),
                step.action,
                self._returned(step.action, step.outcome),
                _bits(step.expected_gain_bits),
                _bits(step.realised_gain_bits),
                _marked(step.surprise),
                f"{step.total_cost_s:g} s",
            )
        return table


def _bits(gain: float | None) -> str:
    return "-" if gain is None else f"{gain:.3f}"


def _marked(surprise: float | None) -> Text:
    """The surprise number, marked where it is small enough to be suspicious."""
    if surprise is None:
        return Text("-")
    return (
        Text(f"{number(surprise, 2)} !", style="bold red")
        if surprise < SURPRISING
        else Text(f"{number(surprise, 2)}  ")
    )


def _surprise(surprise: float | None) -> Text:
    if surprise is None:
        return Text("no surprise number")
    if surprise < SURPRISING:
        return Text(f"surprise {number(surprise, 2)}: surprising!", style="bold red")
    return Text(f"surprise {number(surprise, 2)}")
