"""Scores on groups that were held out: by hand, and on answers that say nothing."""

import numpy as np
import pytest

from palpate.robots.mujoco.training.held_out import Examples, fit_temperature, folds, held_out, scores
from palpate.robots.mujoco.training.report import report


def some(groups: int = 12, each: int = 3) -> Examples:
    numbers = np.repeat(np.arange(groups), each)
    labels = np.array(["a", "b"])[numbers % 2]
    return Examples(numbers.astype(float)[:, None], labels, numbers)


def test_no_group_is_on_both_sides() -> None:
    """Each example is held out once, and whoever answers has not met its group, but each label."""
    examples, met = some(), []

    def answer(learned: Examples, asked: Examples) -> np.ndarray:
        assert not set(learned.groups) & set(asked.groups)
        assert learned.states == ("a", "b")
        met.append(len(asked.labels))
        return np.tile([0.3, 0.7], (len(asked.labels), 1))

    found = held_out(examples, 3, np.random.default_rng(1), answer)
    assert sum(met) == len(examples.labels)
    np.testing.assert_array_equal(found, np.tile([0.3, 0.7], (36, 1)))
    assert np.sum(list(folds(examples, 3, np.random.default_rng(1))), axis=0).tolist() == [1] * 36


def test_saying_nothing_is_worth_nothing() -> None:
    """Equal probabilities gain no bits, and right ones gain log2 of the number of states."""
    labels = np.array(["a", "b", "b", "b"])
    assert scores(np.full((4, 2), 0.5), labels, "ab").gain_bits == 0
    right = scores(np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 1.0], [0.0, 1.0]]), labels, "ab")
    assert right.balanced_accuracy == 1
    assert right.gain_bits == pytest.approx(1, abs=0.002)


def test_rare_states_count_as_much_as_frequent_ones() -> None:
    """Always telling the most frequent of two states has a balanced accuracy of a half."""
    labels = np.array(["a"] + ["b"] * 9)
    assert scores(np.tile([0.1, 0.9], (10, 1)), labels, "ab").balanced_accuracy == 0.5


def test_failures_are_not_right_and_worth_nothing() -> None:
    """An answer that failed is in no column; a state that was not met does not count."""
    found = scores(np.array([[0.9, 0.1, 0.0], [np.nan] * 3]), np.array(["a", "a"]), "abc")
    assert found.failed == 0.5
    np.testing.assert_array_equal(found.confusion[0], [0.5, 0, 0])
    assert found.balanced_accuracy == 0.5
    assert "\n| b |" not in report("Half", found)


def test_the_temperature_undoes_too_much_certainty() -> None:
    """Logits that were made three times too sure have a temperature of three."""
    rng = np.random.default_rng(2)
    logits = rng.normal(0, 1.5, (4000, 3))
    honest = np.exp(logits) / np.exp(logits).sum(axis=1, keepdims=True)
    labels = np.array([rng.choice(list("abc"), p=row) for row in honest])
    sure = honest**3 / (honest**3).sum(axis=1, keepdims=True)
    assert fit_temperature(sure, labels, "abc") == pytest.approx(3, rel=0.1)
    assert fit_temperature(honest, labels, "abc") == pytest.approx(1, rel=0.1)
