"""The optimal adaptive policy tells at least as much as any set."""

from dataclasses import replace

import pytest

import palpate
from palpate.experiments.comparison.optimum import Myopic, OptimumTask
from palpate.experiments.comparison.worlds import worlds
from palpate.inference.predictions import LabelPrediction


def test_the_optimum_is_at_least_the_best_set() -> None:
    """With one action all are the largest expected gain; with two adaptive choices tell more than fixed ones."""
    rows = OptimumTask(worlds()[0], depth=2).run()
    told = {(row["method"], row["step"]): float(str(row["information_bits"])) for row in rows}
    gains = palpate.ExactBelief(worlds()[0].believed).expected_gains([("category", "material")])
    single = [row["category", "material"] or 0.0 for row in gains.values()]
    assert told["optimal", 1] == told["best set", 1] == pytest.approx(max(single))
    assert told["any set", 1] == pytest.approx(sum(single) / 5)
    assert told["optimal", 1] == told["greedy", 1]
    assert told["optimal", 2] >= told["greedy", 2]
    assert told["optimal", 2] > told["best set", 2] > told["any set", 2]


def test_greedy_by_walking_all_labels() -> None:
    """With two labelling actions only, greedy's information is the sum over labels of the largest gain after each."""
    whole = worlds()[0].believed
    names = ("cat-vision", "mat-vision", "mat-sound")
    network = replace(whole, actions={name: whole.actions[name] for name in names})
    objective = palpate.Learn("category", "material")
    belief = palpate.ExactBelief(network)
    gains = objective.gains(belief, names)
    first = max(names, key=lambda name: gains[name])
    left = [name for name in names if name != first]
    expected = gains[first]
    prediction = belief.predict(first)
    assert isinstance(prediction, LabelPrediction)
    for label, p in zip(prediction.outcomes, prediction.probabilities, strict=True):
        expected += p * max(objective.gains(belief.update(first, palpate.Label(label)), left).values())
    assert Myopic(belief, objective, names).best(first, 2) == pytest.approx(expected)
