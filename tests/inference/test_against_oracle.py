"""The exact belief against brute force on dense grids, over 200 evidence sets and small networks."""

from __future__ import annotations

import gzip
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.model import Network
from palpate.network.reading import load_network
from tests.oracle.bridge import believe, outcome
from tests.oracle.brute_force import realised_gains
from tests.oracle.networks import household_oracle

REFERENCE = Path(__file__).parents[1] / "oracle" / "household_reference.json.gz"
PROBABILITY, GAIN_BITS, SDS = 1e-4, 1e-3, 1e-3
LIVE = (0, 4, 7, 10, 59, 156)  # sets asked of the oracle anew, extremes among them


@cache
def reference() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(gzip.decompress(REFERENCE.read_bytes()))
    return found


@cache
def household() -> Network:
    return load_network("household")


def objectives() -> list[str | tuple[str, ...]]:
    return [tuple(z) if isinstance(z, list) else z for z in reference()["objectives"]]


def number(belief: ExactBelief, name: str) -> ContinuousMarginal:
    found = belief.marginal(name)
    assert isinstance(found, ContinuousMarginal)
    return found


def told(index: int) -> str:
    return f"set {index}: {json.dumps(reference()['sets'][index]['evidence'])[:300]}"


@pytest.fixture(scope="module")
def answers() -> list[tuple[int, ExactBelief, dict[str, Any]]]:
    sets = reference()["sets"]
    return [(i, believe(household(), found["evidence"]), found) for i, found in enumerate(sets)]


Answers = list[tuple[int, ExactBelief, dict[str, Any]]]


def test_reference_holds_two_hundred_sets() -> None:
    """The reference covers as many evidence sets as is promised."""
    assert len(reference()["sets"]) == 200


def test_joint_probabilities(answers: Answers) -> None:
    """P(category, material) agrees with brute force to 1e-4."""
    for i, belief, found in answers:
        error = np.abs(belief.probabilities("category", "material") - np.array(found["joint"])).max()
        assert error < PROBABILITY, f"{error:.1e}, {told(i)}"


@pytest.mark.parametrize("name", ["elasticity", "density", "volume", "mass"])
def test_means_and_sds(answers: Answers, name: str) -> None:
    """Means and SDs of continuous properties agree with brute force to 1e-3 SD."""
    for i, belief, found in answers:
        expected, marginal = found["numbers"][name], number(belief, name)
        errors = abs(marginal.mean - expected["mean"]), abs(marginal.sd - expected["sd"])
        assert max(errors) < SDS * expected["sd"], f"{errors}, {expected}, {told(i)}"


@pytest.mark.parametrize("name", ["elasticity", "density", "volume", "mass"])
def test_quantiles(answers: Answers, name: str) -> None:
    """The distribution function at the oracle's quantiles is right to 2e-3."""
    for i, belief, found in answers:
        marginal = number(belief, name)
        for p, x in zip(reference()["quantiles"], found["numbers"][name]["quantiles"], strict=True):
            # Between two clusters of mass a quantile may lie anywhere: compare shares, not values.
            assert abs(marginal.cdf(x) - p) < 2e-3, f"{p}: {marginal.cdf(x)} at {x}, {told(i)}"
            assert abs(marginal.cdf(marginal.quantile(p)) - p) < 1e-6, told(i)


@pytest.mark.parametrize("name", ["elasticity", "density", "volume", "mass"])
def test_differential_entropies(answers: Answers, name: str) -> None:
    """Differential entropies agree with brute force to 5e-3 bits."""
    for i, belief, found in answers:
        error = abs(number(belief, name).entropy_bits - found["numbers"][name]["entropy_bits"])
        assert error < 5e-3, f"{error:.1e}, {told(i)}"


def test_expected_gains(answers: Answers) -> None:
    """Gains of all actions about every objective, joint ones too, agree with brute force to 1e-3 bits."""
    for i, belief, found in answers:
        gains = belief.expected_gains(objectives())
        for action, expected in found["gains"].items():
            errors = [abs((gains[action][z] or 0.0) - e) for z, e in zip(objectives(), expected, strict=True)]
            worst = int(np.argmax(errors))
            assert errors[worst] < GAIN_BITS, f"{action}, {objectives()[worst]}: {errors[worst]:.1e}, {told(i)}"


def test_log_evidence(answers: Answers) -> None:
    """The log of the density of all evidence agrees with brute force to 1e-3 bits."""
    for i, belief, found in answers:
        assert abs(belief.log_evidence_bits - found["log_evidence_bits"]) < 1e-3, told(i)


def test_surprises_and_predictives(answers: Answers) -> None:
    """Surprise and log2 predictive of every item, in the order of the list, agree with brute force."""
    for i, _, found in answers:
        belief, logs = (
            ExactBelief(household()),
            [s["log2_before"] for s in found["steps"]] + [found["log_evidence_bits"]],
        )
        for k, (item, step) in enumerate(zip(found["evidence"], found["steps"], strict=True)):
            surprise = belief.surprise(item["action"], outcome(item))
            if step["surprise"] is None:
                assert surprise is None, told(i)
            else:
                low, high = step["surprise"]
                assert surprise is not None, told(i)
                assert low - 2e-4 <= surprise <= high + 2e-4, f"{k}: {surprise}, {told(i)}"
            predicted = belief.log2_predictive(item["action"], outcome(item))
            assert abs(predicted - (logs[k + 1] - logs[k])) < 2e-3, f"{k}: {predicted}, {told(i)}"
            belief = belief.update(item["action"], outcome(item))


@pytest.mark.parametrize("index", LIVE)
def test_oracle_live(index: int) -> None:
    """The reference file is what the oracle says today, from other grids: it cannot go stale unseen."""
    found = reference()["sets"][index]
    posterior = household_oracle(household(), refine=1.3).posterior(found["evidence"], gains=False)
    assert np.abs(posterior.probabilities("category", "material") - np.array(found["joint"])).max() < 1e-7
    for name, expected in found["numbers"].items():
        assert abs(posterior.moments(name)[0] - expected["mean"]) < 1e-5 * expected["sd"]
    # The file keeps nine digits.
    assert posterior.log2_evidence == pytest.approx(found["log_evidence_bits"], rel=1e-8, abs=1e-6)


REALISED: list[tuple[list[dict[str, Any]], dict[str, Any]]] = [
    ([], {"action": "cat-vision", "label": "mug"}),
    ([{"action": "mat-vision", "label": "ceramic"}], {"action": "squeezing", "above": 95.0}),
    ([{"action": "cat-vision", "label": "fruit"}], {"action": "weighing", "value": 66.0}),
    ([{"action": "weighing", "value": 300.0}], {"action": "weighing", "value": 310.0}),
    ([{"action": "weighing", "value": 300.0}], {"action": "mat-sound", "label": "metal"}),
]


@pytest.mark.parametrize(("items", "item"), REALISED)
def test_realised_gain(items: list[dict[str, Any]], item: dict[str, Any]) -> None:
    """The realised gain of each property is the divergence found on one dense grid."""
    oracle = household_oracle(household())
    before = believe(household(), items)
    after = before.update(item["action"], outcome(item))
    wanted: list[str | tuple[str, ...]] = [*household().properties, ("category", "material")]
    for name, expected in zip(wanted, realised_gains(oracle, items, item, wanted), strict=True):
        assert before.realised_gain(after, name) == pytest.approx(expected, rel=1e-3, abs=1e-3), name
