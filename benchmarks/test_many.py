"""Many explorations at once, decisions per second."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

import palpate
from palpate.inference.batch import gains
from palpate.many import Run

COUNT = 1000
Fixture = Any  # pytest-benchmark's fixture


def alone(belief: palpate.ExactBelief, objective: str, actions: Iterable[str]) -> dict[str, float]:
    """The gains of one belief by itself [bits]."""
    found = belief.expected_gains([objective], list(actions))
    return {action: row[objective] or 0.0 for action, row in found.items()}


@pytest.mark.parametrize(("objective", "per_second"), [("material", 20_000), ("everything", 3_000)])
def test_explore_many(benchmark: Fixture, objective: str, per_second: int) -> None:
    """Decisions per second of vectorised explorations."""
    network = palpate.load_network("household-filled")
    aim = palpate.Everything() if objective == "everything" else palpate.Learn(objective)

    prior, objects = palpate.ExactBelief(network), list(network.objects)

    def setup() -> tuple[tuple[list[palpate.SampledRobot]], dict[str, Any]]:
        rngs = np.random.default_rng(1).spawn(COUNT)
        return ([palpate.SampledRobot(network, objects[i % len(objects)], rng) for i, rng in enumerate(rngs)],), {}

    def run(robots: list[palpate.SampledRobot]) -> list[Run]:
        return palpate.explore_many(prior, robots, objective=aim)

    decisions = sum(len(one.gains_bits) for one in run(*setup()[0]))
    benchmark.extra_info.update(
        what=f"explore_many, one decision, {objective}", each=decisions, target_s=1 / per_second
    )
    found = benchmark.pedantic(run, setup=setup, rounds=3)
    assert sum(len(one.gains_bits) for one in found) == decisions
    for belief, told in zip(found[0].beliefs, found[0].gains_bits, strict=True):
        assert dict(told) == pytest.approx(alone(belief, objective, told))


def test_decisions_alone(benchmark: Fixture) -> None:
    """The expected gains of many beliefs at once, without robots, updates and the loop."""
    network = palpate.load_network("household-filled")
    prior, objects = palpate.ExactBelief(network), list(network.objects)
    rngs = np.random.default_rng(2).spawn(COUNT)
    robots = [palpate.SampledRobot(network, objects[i % len(objects)], rng) for i, rng in enumerate(rngs)]
    runs = palpate.explore_many(prior, robots, objective=palpate.Learn("material"))
    beliefs = [belief for run in runs for belief in run.beliefs[:-1]]
    options = [list(row) for run in runs for row in run.gains_bits[:-1]]
    benchmark.extra_info.update(what="gains of many beliefs at once, material", each=len(beliefs), target_s=1 / 20_000)
    found = benchmark.pedantic(gains, args=(beliefs, "material", options), rounds=5, warmup_rounds=1)
    for belief, told in zip(beliefs[:3], found[:3], strict=True):
        assert dict(told) == pytest.approx(alone(belief, "material", told))
