"""Arms: a way of exploring that is compared with others."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.experiments.engines import Engine
from palpate.selection.policies import Policy
from palpate.selection.stopping import StoppingRule

__all__ = ["Arm"]


@dataclass(frozen=True)
class Arm:
    """An engine, how actions are chosen with it, and when it stops.

    Parameters
    ----------
    name
        What stands in tables and figures.
    scored_by
        The engine whose beliefs are scored, given the same outcomes; the arm's own where None. It
        tells better choices from better inference.
    """

    name: str
    engine: Engine
    policy: Policy
    stopping: StoppingRule
    scored_by: Engine | None = None
