"""The exact belief against brute force on small networks that use what the household one does not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.properties import CategoricalProperty
from tests.oracle.bridge import believe, outcome
from tests.oracle.brute_force import Oracle, realised_gains
from tests.oracle.networks import cube, singles, stack

Items = list[dict[str, Any]]


def _items(*given: tuple[str, str, Any]) -> Items:
    return [{"action": action, kind: value} for action, kind, value in given]


CASES: list[tuple[Callable[[], Oracle], Items]] = [
    (cube, []),
    (cube, _items(("look", "label", "z"), ("look", "label", "z"), ("look", "label", "x"), ("glint", "label", "odd"))),
    (cube, _items(("dunk", "value", 40.0), ("ruler", "value", 3.9))),
    (cube, _items(("dunk", "value", 400.0), ("dunk", "value", 380.0), ("touch", "value", 12.0))),
    (cube, _items(("touch", "below", 3.0), ("touch", "value", 4.0), ("touch", "value", 4.5), ("look", "label", "y"))),
    (cube, [{"action": "dunk", "value": 40.0, "sd": 0.5}, {"action": "touch", "above": 20.0}]),
    (stack, []),
    (stack, _items(("rod", "value", 15.0))),
    (stack, _items(("rod", "value", 15.0), ("rod", "value", 15.5), ("rod", "value", 14.0))),
    (stack, _items(("laser", "value", 30.0), ("laser", "value", 12.0))),
    (stack, _items(("gauge", "below", 5.0), ("laser", "value", 9.0), ("glance", "label", "r"))),
    (stack, _items(("gauge", "value", 8.0), ("rod", "above", 14.0), ("rod", "value", 15.0))),
    (singles, []),
    (singles, _items(("float", "below", 5.0), ("sight", "label", "b"))),
    (singles, _items(("float", "above", 90.0), ("float", "value", 85.0))),
    (
        singles,
        _items(("probe", "value", 8.0), ("probe", "value", -2.0), ("sight", "label", "a"), ("sight", "label", "a")),
    ),
    (singles, _items(("feeler", "value", 4.8), ("feeler", "value", 4.6), ("feeler", "above", 5.0))),
    (singles, _items(("feeler", "value", -1.0), ("probe", "value", 50.0))),
]
IDS = [f"{make.__name__}-{i}" for i, (make, _) in enumerate(CASES)]


def objectives(oracle: Oracle) -> list[str | tuple[str, ...]]:
    """Every property, everything, all categorical ones together, and each with one continuous one."""
    categorical = [p.name for p in oracle.network.categorical]
    mixed = [(categorical[0], p.name) for p in oracle.network.continuous]
    return [*oracle.network.properties, "everything", tuple(categorical), *mixed]


@pytest.mark.parametrize(("make", "items"), CASES, ids=IDS)
def test_belief(make: Callable[[], Oracle], items: Items) -> None:
    """Probabilities, means, SDs, quantiles, entropies and log evidence agree with brute force."""
    oracle = make()
    posterior, belief = oracle.posterior(items), believe(oracle.network, items)
    assert belief.log_evidence_bits == pytest.approx(posterior.log2_evidence, abs=1e-3)
    names = [p.name for p in oracle.network.categorical]
    assert np.abs(belief.probabilities(*names) - posterior.probabilities(*names)).max() < 1e-4
    for name, prop in oracle.network.properties.items():
        marginal = belief.marginal(name)
        assert marginal.entropy_bits == pytest.approx(posterior.entropy_bits(name), abs=2e-3), name
        if not isinstance(prop, CategoricalProperty):
            assert isinstance(marginal, ContinuousMarginal)
            mean, sd = posterior.moments(name)
            assert (marginal.mean, marginal.sd) == pytest.approx((mean, sd), abs=1e-3 * sd), name
            for p in (0.05, 0.5, 0.95):
                assert marginal.cdf(posterior.quantile(name, p)) == pytest.approx(p, abs=1e-3), name


@pytest.mark.parametrize(("make", "items"), CASES, ids=IDS)
def test_gains(make: Callable[[], Oracle], items: Items) -> None:
    """Expected gains of all actions about single and joint objectives agree with brute force."""
    oracle = make()
    posterior, wanted = oracle.posterior(items), objectives(oracle)
    gains = believe(oracle.network, items).expected_gains(wanted)
    for action in oracle.network.actions:
        for objective in wanted:
            expected = posterior.gain(objective, action)
            assert gains[action][objective] == pytest.approx(expected, abs=1e-3), (action, objective)


@pytest.mark.parametrize(("make", "items"), CASES, ids=IDS)
def test_steps(make: Callable[[], Oracle], items: Items) -> None:
    """Surprise and log2 predictive of each item, given those before, agree with brute force."""
    oracle = make()
    belief, bits = ExactBelief(oracle.network), 0.0
    for i, item in enumerate(items):
        low, high = oracle.posterior(items[:i], gains=False, features=items).surprise(item) or (0.0, 0.0)
        surprise = belief.surprise(item["action"], outcome(item))
        assert surprise is not None
        assert low - 2e-4 <= surprise <= high + 2e-4
        bits += belief.log2_predictive(item["action"], outcome(item))
        belief = belief.update(item["action"], outcome(item))
    assert bits == pytest.approx(belief.log_evidence_bits, abs=1e-8)


@pytest.mark.parametrize(("make", "items"), [case for case in CASES if len(case[1]) > 1])
def test_realised(make: Callable[[], Oracle], items: Items) -> None:
    """The realised gain of the last item is the divergence on one dense grid, for each property."""
    oracle = make()
    before = believe(oracle.network, items[:-1])
    after = before.update(items[-1]["action"], outcome(items[-1]))
    wanted = list(oracle.network.properties)
    for name, expected in zip(wanted, realised_gains(oracle, items[:-1], items[-1], wanted), strict=True):
        assert before.realised_gain(after, name) == pytest.approx(expected, rel=1e-3, abs=1e-3), name
