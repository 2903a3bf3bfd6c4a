"""pyAgrum on the same network cut into 64 bins: the same update and the same decision, same run."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Any

import pytest

import palpate
from benchmarks.agrum import Rival

Fixture = Any  # pytest-benchmark's fixture


@pytest.fixture(scope="module")
def rival() -> Any:
    """The rival, once it has answered the same question: its gains are near ours, as far as its bins allow."""
    network = palpate.load_network("household")
    rival, belief = Rival(network), palpate.ExactBelief(network)
    belief = belief.update("cat-vision", palpate.Label("mug")).update("squeezing", palpate.Reading(60.0))
    seen: dict[str, str | float] = {"cat-vision": "mug", "squeezing": 60.0}
    ours, theirs, marginals = belief.expected_gains(), rival.decide(seen), rival.update(seen)
    for action in ("cat-vision", "mat-vision", "mat-sound", "squeezing"):
        assert theirs[action, "material"] == pytest.approx(ours[action]["material"], abs=0.05)
    for name in ("category", "material"):
        assert marginals[name] == pytest.approx(belief.probabilities(name), abs=0.02)
    return rival


def measure(benchmark: Fixture, call: Callable[[dict[str, str | float]], Any], what: str) -> None:
    numbers = count()

    def setup() -> tuple[tuple[dict[str, str | float]], dict[str, Any]]:
        i = next(numbers)
        squeeze, weight = 20.0 + 0.37 * (i % 150), 60.0 + 1.3 * (i % 211)
        return ({"cat-vision": "mug", "mat-vision": "ceramic", "squeezing": squeeze, "weighing": weight},), {}

    benchmark.extra_info.update(what=what)
    benchmark.pedantic(call, setup=setup, rounds=30, warmup_rounds=3)


def test_agrum_decision(benchmark: Fixture, rival: Any) -> None:
    """Mutual information of every property and action after four observations."""
    measure(benchmark, rival.decide, "pyAgrum, 64 bins: decision after four observations")


def test_agrum_update(benchmark: Fixture, rival: Any) -> None:
    """Marginals of every property after four observations."""
    measure(benchmark, rival.update, "pyAgrum, 64 bins: update by a weighing, all marginals")
