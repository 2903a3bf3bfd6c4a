"""The inference engines by the names the command line knows them by."""

from __future__ import annotations

from collections.abc import Callable

from palpate.errors import PalpateError, choices, near
from palpate.inference.belief import Belief
from palpate.network.model import Network

__all__ = ["engine_words", "prior_belief"]


DEFAULT_PRESET = "as-released"


def engine_words(engine: str, preset: str | None) -> str:
    """An engine as people read it, its preset with it where it has one."""
    return engine if engine == "exact" else f"{engine} {preset or DEFAULT_PRESET}"


def _exact(network: Network, preset: str | None, seed: int) -> Belief:
    from palpate.inference.exact import ExactBelief

    if preset is not None:
        raise PalpateError(f"--preset {preset} is only for --engine message-passing, and the engine is exact")
    return ExactBelief(network)


def _message_passing(network: Network, preset: str | None, seed: int) -> Belief:
    from palpate.inference.message_passing import MessagePassingBelief, Settings

    presets = {
        "as-released": Settings.as_released,
        "repaired": Settings.repaired,
        "as-written": Settings.as_written,
    }
    name = preset or DEFAULT_PRESET
    if name not in presets:
        raise PalpateError(f"--preset: unknown preset {name!r}{near(name, presets)}; {choices(presets)}")
    return MessagePassingBelief(network, presets[name](), seed)


ENGINES: dict[str, Callable[[Network, str | None, int], Belief]] = {
    "exact": _exact,
    "message-passing": _message_passing,
}


def prior_belief(engine: str, network: Network, preset: str | None = None, seed: int = 0) -> Belief:
    """The belief without evidence, by the engine of that name.

    Parameters
    ----------
    preset
        What the engine is set to, where it has presets; None is its default.
    seed
        Of the engine's own chance, where it has any.
    """
    if engine not in ENGINES:
        raise PalpateError(f"--engine: unknown engine {engine!r}{near(engine, ENGINES)}; {choices(ENGINES)}")
    return ENGINES[engine](network, preset, seed)
