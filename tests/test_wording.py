import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading
from palpate.wording import number, outcome_words


@given(st.floats(-1e300, 1e300), st.integers(1, 6))
def test_a_number_keeps_its_significant_digits(value: float, digits: int) -> None:
    """What is shown differs from the number by less than half a unit of the last significant digit."""
    assert float(number(value, digits)) == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits), abs=5e-324)


@pytest.mark.parametrize(
    ("outcome", "words"),
    [
        (Label("mug"), "mug"),
        (Reading(118.0), "118 g"),
        (Reading(0.118, unit="kg"), "0.118 kg"),
        (Reading(66.31, 0.7987), "66.3 ± 0.80 g"),
        (Reading(0.118, 0.006, "kg"), "0.118 ± 0.0060 kg"),
        (Above(95.0), "above 95.0 g"),
        (Below(5.0), "below 5.00 g"),
        (Likelihood({"glass": 0.25, "wood": 1.0}), "likelihood: wood 1.0, glass 0.25"),
        (Posterior({"a": 0.1, "b": 0.3, "c": 0.6}), "posterior: c 0.60, b 0.30, ..."),
        (Failed(), "failed"),
        (Failed("lost it"), "failed: lost it"),
    ],
)
def test_outcomes_in_words(outcome: Outcome, words: str) -> None:
    """Each kind of outcome has its words; a number's own unit comes before the property's."""
    assert outcome_words(outcome, "g") == words
