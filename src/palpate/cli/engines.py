"""The inference engines by the names the command line knows them by."""

from __future__ import annotations

from collections.abc import Callable

from palpate.errors import PalpateError, choices
from palpate.inference.belief import Belief
from palpate.network.model import Network

__all__ = ["prior_belief"]


def _exact(network: Network) -> Belief:
    from palpate.inference.exact import ExactBelief

    return ExactBelief(network)


ENGINES: dict[str, Callable[[Network], Belief]] = {"exact": _exact}


def prior_belief(engine: str, network: Network) -> Belief:
    """The belief without evidence, by the engine of that name."""
    if engine not in ENGINES:
        raise PalpateError(f"--engine: unknown engine {engine!r}; {choices(ENGINES)}")
    return ENGINES[engine](network)
