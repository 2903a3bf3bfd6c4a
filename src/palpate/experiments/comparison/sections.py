"""What the sections of the report share."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.experiments.comparison.methods import all_methods
from palpate.experiments.comparison.results import Results

__all__ = ["METHOD_WORDS", "methods_of", "own_methods_of", "settings_words"]

METHOD_WORDS = {method.name: method.words for method in all_methods()}
"""Method to what people read."""


def methods_of(own: Results) -> list[str]:
    """The methods that were run there, in the order of all."""
    there = own.distinct("method")
    return [name for name in METHOD_WORDS if name in there]


def own_methods_of(own: Results) -> list[str]:
    """Those whose own beliefs are scored."""
    return [name for name in methods_of(own) if "-scored-" not in name]


def settings_words(settings: Mapping[str, object]) -> str:
    """What was run, in a few words.

    Examples
    --------
    >>> settings_words({"seed": 0, "size": "quick"})
    'seed 0, size quick'
    """
    return ", ".join(f"{name} {value}" for name, value in settings.items())
