"""Speed of what people and robots wait for; run by `make bench`.

Each round sees another reading, so that nothing kept from the round before can help.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import count
from typing import Any

import numpy as np
import pytest

import palpate
from palpate.selection.policies import Choice

Fixture = Any  # pytest-benchmark's fixture
LABELS = {"cat-vision": "mug", "mat-vision": "ceramic"}
ROUNDS = 200


@pytest.fixture(scope="module")
def network() -> palpate.Network:
    return palpate.load_network("household")


def readings() -> Iterator[tuple[float, float]]:
    """(squeeze [kPa], weight [g]) of round after round, no two alike."""
    return ((20.0 + 0.37 * (i % 150), 60.0 + 1.3 * (i % 211)) for i in count())


def three(network: palpate.Network, squeeze: float) -> palpate.ExactBelief:
    """Three observations; the weighing is still to come."""
    belief = palpate.ExactBelief(network)
    for action, label in LABELS.items():
        belief = belief.update(action, palpate.Label(label))
    return belief.update("squeezing", palpate.Reading(squeeze))


def marginals(belief: palpate.ExactBelief) -> list[float]:
    """All that is shown of every property: probabilities; mean, SD and entropy."""
    return [belief.marginal(name).entropy_bits for name in belief.network.properties]


def turned(network: palpate.Network, *evidence: tuple[str, palpate.Outcome]) -> palpate.ExactBelief:
    """The belief given the evidence, the last of it first: whatever the order, it must be the same."""
    belief = palpate.ExactBelief(network)
    for action, outcome in reversed(evidence):
        belief = belief.update(action, outcome)
    return belief


def four(squeeze: float, weight: float) -> list[tuple[str, palpate.Outcome]]:
    """Four observations."""
    numbers = {"squeezing": palpate.Reading(squeeze), "weighing": palpate.Reading(weight)}
    return [*((action, palpate.Label(label)) for action, label in LABELS.items()), *numbers.items()]


def bits(belief: palpate.ExactBelief) -> list[float | None]:
    """The gains of all actions about everything that can be asked."""
    return [gain for row in belief.expected_gains().values() for gain in row.values()]


def measure(
    benchmark: Fixture, call: Callable[..., Any], setup: Callable[[], Any], target_ms: float, what: str, **info: Any
) -> Any:
    """Time rounds; what the last one gave."""
    benchmark.extra_info.update(what=what, target_s=target_ms / 1e3, **info)
    return benchmark.pedantic(call, setup=lambda: (setup(), {}), rounds=ROUNDS, warmup_rounds=10)


def test_decision(benchmark: Fixture, network: palpate.Network) -> None:
    """Gains of five actions about every property and everything, after four observations."""
    values, last = readings(), [0.0, 0.0]

    def setup() -> tuple[palpate.ExactBelief]:
        last[:] = next(values)
        belief = three(network, last[0]).update("weighing", palpate.Reading(last[1]))
        marginals(belief)  # the loop has shown the belief by the time it decides
        return (belief,)

    what = "decision after four observations"
    found = measure(benchmark, lambda b: b.expected_gains(), setup, 0.4, what, rival="test_agrum_decision")
    told = [gain for row in found.values() for gain in row.values()]
    assert told == pytest.approx(bits(turned(network, *four(*last))), abs=1e-9)


def test_update_with_weighing(benchmark: Fixture, network: palpate.Network) -> None:
    """The fourth observation, a weighing, with all marginals."""
    values, last = readings(), [0.0, 0.0]

    def setup() -> tuple[palpate.ExactBelief, float]:
        last[:] = next(values)
        return three(network, last[0]), last[1]

    def call(belief: palpate.ExactBelief, weight: float) -> list[float]:
        return marginals(belief.update("weighing", palpate.Reading(weight)))

    what = "update by a weighing, all marginals"
    found = measure(benchmark, call, setup, 0.3, what, rival="test_agrum_update")
    assert found == pytest.approx(marginals(turned(network, *four(*last))), abs=1e-9)


def test_update_beside_weighing(benchmark: Fixture, network: palpate.Network) -> None:
    """A label after a weighing and a squeeze, with all marginals."""
    values, last = readings(), [0.0, 0.0]

    def setup() -> tuple[palpate.ExactBelief]:
        last[:] = next(values)
        return (three(network, last[0]).update("weighing", palpate.Reading(last[1])),)

    def call(belief: palpate.ExactBelief) -> list[float]:
        return marginals(belief.update("mat-sound", palpate.Label("ceramic")))

    found = measure(benchmark, call, setup, 0.3, "update by a label after a weighing, all marginals")
    evidence = [*four(*last), ("mat-sound", palpate.Label("ceramic"))]
    assert found == pytest.approx(marginals(turned(network, *evidence)), abs=1e-9)


def test_update_without_weighing(benchmark: Fixture, network: palpate.Network) -> None:
    """A squeeze after two labels, with all marginals, nothing having been weighed."""
    values, last, belief = readings(), [0.0, 0.0], palpate.ExactBelief(network)
    for action, label in LABELS.items():
        belief = belief.update(action, palpate.Label(label))

    def setup() -> tuple[float]:
        last[:] = next(values)
        return (last[0],)

    def call(squeeze: float) -> list[float]:
        return marginals(belief.update("squeezing", palpate.Reading(squeeze)))

    found = measure(benchmark, call, setup, 0.1, "update by a squeeze, all marginals, no weighing")
    assert found == pytest.approx(marginals(turned(network, *four(*last)[:3])), abs=1e-9)


def test_update_and_decision(benchmark: Fixture, network: palpate.Network) -> None:
    """The two together: nothing is left out between them."""
    values, last = readings(), [0.0, 0.0]

    def setup() -> tuple[palpate.ExactBelief, float]:
        last[:] = next(values)
        return three(network, last[0]), last[1]

    def call(belief: palpate.ExactBelief, weight: float) -> list[float | None]:
        after = belief.update("weighing", palpate.Reading(weight))
        marginals(after)
        return bits(after)

    found = measure(benchmark, call, setup, 0.7, "update by a weighing, marginals and decision together")
    assert found == pytest.approx(bits(turned(network, *four(*last))), abs=1e-9)


def test_lookahead(benchmark: Fixture, network: palpate.Network) -> None:
    """Look-ahead of depth three over five actions from the prior, objective material, no repeats."""
    objective, costs = palpate.Learn("material"), {name: a.cost_s for name, a in network.actions.items()}

    def setup() -> tuple[Choice]:
        belief = palpate.ExactBelief(network)
        return (Choice(belief, objective, objective.gains(belief, network.actions), costs, np.random.default_rng(0)),)

    benchmark.extra_info.update(what="look-ahead of depth 3, material", target_s=0.150)
    found = benchmark.pedantic(palpate.LookAhead(3).choose, setup=lambda: (setup(), {}), rounds=7, warmup_rounds=1)
    assert found == "mat-sound"


def _fresh(code: list[str], stdin: str = "") -> str:
    return subprocess.run([sys.executable, *code], input=stdin, text=True, check=True, capture_output=True).stdout


def test_python_itself(benchmark: Fixture) -> None:
    """An empty interpreter: what the two figures below hold that is not ours."""
    benchmark.extra_info.update(what="python -c pass (for comparison)")
    benchmark.pedantic(_fresh, args=(["-c", "pass"],), rounds=7, warmup_rounds=1)


def test_import(benchmark: Fixture) -> None:
    """`import palpate` in a fresh interpreter."""
    benchmark.extra_info.update(what="import palpate, fresh interpreter", target_s=0.3)
    benchmark.pedantic(_fresh, args=(["-c", "import palpate"],), rounds=7, warmup_rounds=1)


def test_infer_cold(benchmark: Fixture) -> None:
    """`palpate infer` on four observations, cold."""
    evidence = (
        '{"evidence": [{"action": "cat-vision", "label": "mug"}, {"action": "mat-sound", "label": "ceramic"},'
        ' {"action": "weighing", "value": 118, "unit": "g"}, {"action": "squeezing", "above": 95, "unit": "kPa"}]}'
    )
    benchmark.extra_info.update(what="palpate infer --json, cold", target_s=0.6)
    command = ["-m", "palpate", "infer", "-", "--json"]
    found = benchmark.pedantic(_fresh, args=(command, evidence), rounds=7, warmup_rounds=1)
    category = json.loads(found)["properties"]["category"]["probabilities"]
    assert max(category, key=category.get) == "mug"
