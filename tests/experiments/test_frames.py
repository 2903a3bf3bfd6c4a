"""Columns and the rows asked for."""

import math

import numpy as np
import pyarrow as pa

from palpate.experiments.frames import Frame

TABLE = pa.table({"who": ["a", None, "b", "a"], "bits": [1.0, 2.0, None, 3.0], "on": [True, False, True, False]})


def test_missing_values_are_nan_and_none() -> None:
    """A missing number is no number, a missing text is None."""
    frame = Frame.of(TABLE)
    assert math.isnan(frame["bits"][2])
    assert frame["who"][1] is None
    assert (len(frame), frame.names) == (4, ("who", "bits", "on"))


def test_rows_are_picked_by_equality() -> None:
    """All columns named must be equal; a value that does not occur leaves nothing."""
    frame = Frame.of(TABLE)
    assert frame.where(who="a", on=False)["bits"].tolist() == [3.0]
    assert len(frame.where(who="c")) == 0
    assert frame.unique("who") == ["a", "b"]


def test_means_leave_missing_numbers_out() -> None:
    """Only what is there counts, and nothing has no mean."""
    means = Frame.of(TABLE).means("bits", "who")
    assert means["a"] == np.mean([1.0, 3.0])
    assert math.isnan(means["b"])
