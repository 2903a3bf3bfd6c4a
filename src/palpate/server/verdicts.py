"""What is known of an object beside what an exploration believes of it, and whether the two agree."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from palpate.network.units import UnitError, factor
from palpate.server.plots.drawing import number
from palpate.store.entries import Distribution, Value
from palpate.store.rows import most_probable
from palpate.store.things import Known
from palpate.summary import BeliefSummary, CategoricalSummary, ContinuousSummary

__all__ = ["Verdict", "verdicts"]


@dataclass(frozen=True)
class Verdict:
    """What is known of a property, from where, and whether the belief agrees, with why in words."""

    known: str
    source: str
    is_found: bool
    words: str

    @property
    def mark(self) -> str:
        """A tick or a cross; the words say it too."""
        return "\N{CHECK MARK}" if self.is_found else "\N{BALLOT X}"


def verdicts(known: Iterable[Known], belief: BeliefSummary) -> Mapping[str, Verdict]:
    """By property, where both something is known and something is believed; what was told last counts.

    A state counts as found where it is the most probable one, a number where it lies in the 90 % interval.
    """
    found = {}
    for one in known:
        name = one.entry.property or ""
        verdict = _verdict(one, belief.get(name))
        if verdict is not None:
            found[name] = verdict
    return found


def _verdict(known: Known, believed: object) -> Verdict | None:
    entry = known.entry
    if isinstance(entry, Distribution) and isinstance(believed, CategoricalSummary):
        return _of_state(most_probable(entry.probabilities), known.source, believed)
    if isinstance(entry, Value) and isinstance(believed, ContinuousSummary):
        return _of_number(entry, known.source, believed)
    return None


def _of_state(state: str, source: str, believed: CategoricalSummary) -> Verdict | None:
    if state not in believed.probabilities:
        return None
    best = max(believed.probabilities, key=lambda one: believed.probabilities[one])
    share, of_best = f"{believed.probabilities[state]:.0%}", f"{believed.probabilities[best]:.0%}"
    words = (
        f"found: the most probable, {share}"
        if best == state
        else f"not found: {best} is more probable ({of_best}) than {state} ({share})"
    )
    return Verdict(state, source, best == state, words)


def _of_number(entry: Value, source: str, believed: ContinuousSummary) -> Verdict | None:
    try:
        value = entry.value * factor(entry.unit or believed.unit, believed.unit)
    except UnitError:
        return None
    is_found = believed.quantiles["0.05"] <= value <= believed.quantiles["0.95"]
    words = "found: inside the 90 % interval" if is_found else "not found: outside the 90 % interval"
    return Verdict(f"{number(value)} {believed.unit}", source, is_found, words)
