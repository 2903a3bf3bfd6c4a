"""Reading the table of a comparison, on rows made up by hand."""

import numpy as np
import pytest

from palpate.experiments.running import Row
from tests.experiments.made_up import results, row


def lattice(weight_of_one: float = 0.5) -> list[Row]:
    """One object of which rows stand for sets of actions."""
    sets = {"": (0, 1.0), "a": (1, weight_of_one), "b": (1, weight_of_one), "a+b": (2, 1.0)}
    return [row("w", "rand", "o0", step, used=used, weight=weight) for used, (step, weight) in sets.items()]


def test_properties_are_told_apart_by_their_columns() -> None:
    """Categorical properties have a cross-entropy, continuous ones a CRPS."""
    own = results([row("w", "m", "o0", 0)])
    assert (own.categorical, own.continuous) == (("kind",), ("size",))


def test_missing_truths_do_not_count() -> None:
    """Over the states only what is known counts, and rows of which nothing is known are no numbers."""
    own = results([row("w", "m", "o0", 0, kind_brier=None), row("w", "m", "o1", 0, kind_brier=0.25)])
    assert np.isnan(own.over_states("brier")[0])
    assert own.mean(own.over_states("brier")) == 0.25


def test_objects_are_the_unit() -> None:
    """Two rows of one object count as much as one row of another."""
    own = results([row("w", "m", thing, 0, size_crps=value) for thing, value in (("o0", 0), ("o0", 2), ("o1", 5))])
    assert own.mean(own.numbers("size_crps")) == 3


def test_rows_of_sets_stand_for_all_orders() -> None:
    """Two actions have two orders; both begin and end at the same rows."""
    paths = list(results(lattice()).paths())
    assert [(path.weight, path.rows.tolist()) for path in paths] == [(0.5, [0, 1, 3]), (0.5, [0, 2, 3])]


def test_rows_of_sequences_are_chained() -> None:
    """Where order matters, each full sequence is a path through its own beginnings."""
    used = ["", "a", "b", "a+b", "b+a"]
    rows = [row("w", "m", "o0", text.count("+") + bool(text), used=text) for text in used]
    assert [path.rows.tolist() for path in results(rows).paths()] == [[0, 1, 3], [0, 2, 4]]


def test_one_row_per_step_is_one_path() -> None:
    """A method with one course has one path per object and repetition, in the order of steps."""
    rows = [row("w", "m", "o0", step, repetition=r) for r in (0, 1) for step in (2, 0, 1)]
    assert [path.rows.tolist() for path in results(rows).paths()] == [[1, 2, 0], [4, 5, 3]]


def test_a_curve_is_the_mean_over_objects_step_by_step() -> None:
    """The mean lies in its interval, and is that of the objects."""
    rows = [row("w", "m", f"o{i}", step, kind_brier=float(i + step)) for i in range(3) for step in range(2)]
    curve = results(rows).curve("brier")
    assert (curve.steps, curve.mean) == ((0, 1), (1.0, 2.0))
    assert all(low <= mean <= high for low, mean, high in zip(curve.low, curve.mean, curve.high, strict=True))


def test_stacked_beliefs_leave_out_unknown_truths() -> None:
    """Probabilities, true states and weights are of the rows that know the truth."""
    own = results([row("w", "m", "o0", 0, kind_truth=None), row("w", "m", "o1", 0, kind_truth=1, weight=0.5)])
    p, truth, weights = own.stacked("kind")
    assert (p.shape, truth.tolist(), weights.tolist()) == ((1, 2), [1], [0.5])
    assert p.sum() == pytest.approx(1)
