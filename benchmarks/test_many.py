"""Many explorations at once, decisions per second."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import palpate
from palpate.inference.batch import gains

COUNT = 1000
Fixture = Any  # pytest-benchmark's fixture


@pytest.mark.parametrize(("objective", "per_second"), [("material", 20_000), ("everything", 3_000)])
def test_explore_many(benchmark: Fixture, objective: str, per_second: int) -> None:
    """Decisions per second of vectorised explorations."""
    network = palpate.load_network("household-filled")
    aim = palpate.Everything() if objective == "everything" else palpate.Learn(objective)

    prior, objects = palpate.ExactBelief(network), list(network.objects)

    def setup() -> tuple[tuple[list[palpate.SampledRobot]], dict[str, Any]]:
        rngs = np.random.default_rng(1).spawn(COUNT)
        return ([palpate.SampledRobot(network, objects[i % len(objects)], rng) for i, rng in enumerate(rngs)],), {}

    def run(robots: list[palpate.SampledRobot]) -> int:
        runs = palpate.explore_many(prior, robots, objective=aim)
        return sum(len(run.gains_bits) for run in runs)

    decisions = run(*setup()[0])
    benchmark.extra_info.update(
        what=f"explore_many, one decision, {objective}", each=decisions, target_s=1 / per_second
    )
    benchmark.pedantic(run, setup=setup, rounds=3)


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
    benchmark.pedantic(gains, args=(beliefs, "material", options), rounds=5, warmup_rounds=1)
