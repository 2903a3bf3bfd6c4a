import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Posterior, Reading
from palpate.recording.results import Outcome, entries_of
from palpate.store.entries import Bound, Distribution, FailedEntry, Interval, Value


@pytest.mark.parametrize(
    ("result", "entry"),
    [
        (Reading(1.0, sd=2.0, unit="g"), Value("x", 1.0, 2.0, "g")),
        (Reading(math.nan), FailedEntry("the value is nan", "x")),
        (Above(95.0, unit="kPa"), Bound("x", above=95.0, unit="kPa")),
        (Below(5.0), Bound("x", below=5.0)),
        (Failed("slipped"), FailedEntry("slipped", "x")),
        (Failed(), FailedEntry("the action gave nothing", "x")),
        (Label("mug"), Distribution("x", {"mug": 1.0})),
        (Posterior({"mug": 0.5, "box": 0.5}), Distribution("x", {"mug": 0.5, "box": 0.5})),
        (Outcome.interval("y", 1.0, 2.0), Interval("y", 1.0, 2.0)),
        (Outcome.above("y", 1.0, unit="g"), Bound("y", above=1.0, unit="g")),
        (Outcome.below("y", 1.0), Bound("y", below=1.0)),
        (Outcome.failed("no"), FailedEntry("no")),
        (Outcome.categorical("y", {"a": 1.0}), Distribution("y", {"a": 1.0})),
    ],
)
def test_each_kind_of_result_is_an_entry(result: Any, entry: Any) -> None:
    """What robots return and what `Outcome` makes becomes the entry that says the same."""
    assert entries_of(result, "x")[0] == (entry,)


def test_several_entries_are_taken_and_nothing_is_none() -> None:
    """A list of entries is all of them; None is no entry, without a notice."""
    both = [Outcome.failed("a"), Outcome.failed("b")]
    assert entries_of(both, "x") == (tuple(both), ())
    assert entries_of(None, "x") == ((), ())


@given(st.dictionaries(st.text(min_size=1, max_size=3), st.floats(0.01, 10.0), min_size=1, max_size=4))
def test_vectors_are_kept_summing_to_one(weights: dict[str, float]) -> None:
    """Likelihoods keep their ratios and sum to one; that they were divided is told."""
    (entry,), notices = entries_of(Likelihood(weights), "x")
    assert isinstance(entry, Distribution)
    assert math.fsum(entry.probabilities.values()) == pytest.approx(1.0)
    assert bool(notices) == (abs(math.fsum(weights.values()) - 1) >= 1e-9)
