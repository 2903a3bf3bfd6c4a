"""What became of a claim: what each engine's table says of it, and that in a few words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from palpate.experiments.engines import engine_words
from palpate.experiments.reproduction.paper import Claim

__all__ = ["Finding", "Verdict"]


@dataclass(frozen=True)
class Finding:
    """Whether a claim holds for an engine, and the figure that says so.

    Parameters
    ----------
    holds
        None where there is no run that could tell.
    chance
        Whether the figure may be due to chance: the 95 % interval of the difference holds zero.
    """

    holds: bool | None
    figure: str
    chance: bool = False


@dataclass(frozen=True)
class Verdict:
    """A claim, what each engine's table says of it, and that in a few words."""

    claim: Claim
    findings: Mapping[str, Finding]

    @property
    def words(self) -> str:
        """The verdict over all engines.

        Examples
        --------
        >>> claim = Claim("first", ("category",), "Cat-vision comes first")
        >>> Verdict(claim, {"as-released": Finding(True, ""), "exact": Finding(False, "")}).words
        'holds only as released'
        """
        told = {engine: found.holds for engine, found in self.findings.items() if found.holds is not None}
        if not told:
            return "no run can tell"
        holding = [engine for engine, holds in told.items() if holds]
        words = _held_by(holding, [engine for engine in told if engine not in holding])
        doubtful = [engine for engine in holding if self.findings[engine].chance]
        return f"{words}; may be chance for {_listed(doubtful)}" if doubtful else words


def _held_by(holding: Sequence[str], failing: Sequence[str]) -> str:
    if not failing:
        return "holds"
    if not holding:
        return "does not hold"
    if list(holding) == ["as-released"]:
        return "holds only as released"
    return (
        f"holds, but not for {_listed(failing)}"
        if len(failing) < len(holding)
        else f"holds only for {_listed(holding)}"
    )


def _listed(engines: Sequence[str]) -> str:
    return ", ".join(map(engine_words, engines))
