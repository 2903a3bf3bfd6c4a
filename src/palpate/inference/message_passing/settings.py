"""Settings of the message-passing engine, and the three presets that people ask for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

__all__ = ["Settings"]


@dataclass(frozen=True)
class Settings:
    """Where the published program and the published equations differ, and the numbers of both.

    Source: Kruzliak et al., IROS 2024, doi 10.1109/IROS58592.2024.10802249, and the behaviour of
    the program released with it. Make one by `as_released`, `repaired` or `as_written`.

    Parameters
    ----------
    quotient_counts
        Whether a reading of a derived property (a weighing) changes the node it is about. Where it
        does not, messages leave that node's unchanged belief all the same.
    emulation_times_belief
        Whether the emulated belief of a continuous node, its density blurred by the action's noise,
        is multiplied by the density once more.
    outcome_error
        Share of each state of an outcome vector that is spread evenly over the other states.
    fit_samples, fit_iterations, refits
        Samples of a density for a mixture fit, iterations of it, and how often it is tried again,
        each time with as many samples more and one more times the iterations.
    tolerance
        Gain in mean log likelihood per sample below which a fit has converged [nats].
    quotient_samples, quotient_iterations
        Samples and iterations of the fit to quotients of a reading and a belief; it is tried once.

    Examples
    --------
    >>> Settings.as_released().quotient_counts, Settings.repaired().quotient_counts
    (False, True)
    """

    quotient_counts: bool
    emulation_times_belief: bool
    outcome_error: float = 0.01
    fit_samples: int = 5_000
    fit_iterations: int = 100
    refits: int = 2
    tolerance: float = 1e-6
    quotient_samples: int = 10_000
    quotient_iterations: int = 500

    @classmethod
    def as_released(cls) -> Self:
        """The released program: the reading of a weighing has no effect."""
        return cls(quotient_counts=False, emulation_times_belief=True)

    @classmethod
    def repaired(cls) -> Self:
        """The released program with weighing stored as was meant."""
        return replace(cls.as_released(), quotient_counts=True)

    @classmethod
    def as_written(cls) -> Self:
        """The equations of the paper: repaired, and emulated beliefs are blurred and no more."""
        return replace(cls.repaired(), emulation_times_belief=False)
