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
    return Rival(palpate.load_network("household"))


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


def test_agrum_agrees(rival: Any) -> None:
    """The rival answers the same question: its gains are near ours, as far as its bins allow."""
    belief = palpate.ExactBelief(palpate.load_network("household"))
    belief = belief.update("cat-vision", palpate.Label("mug")).update("squeezing", palpate.Reading(60.0))
    ours, theirs = belief.expected_gains(), rival.decide({"cat-vision": "mug", "squeezing": 60.0})
    for action in ("cat-vision", "mat-vision", "mat-sound", "squeezing"):
        assert theirs[action, "material"] == pytest.approx(ours[action]["material"], abs=0.05)
