import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.errors import EvidenceError
from palpate.evidence import format_item, parse_item
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Posterior, Reading

numbers = st.floats(-1e6, 1e6)
positive = st.floats(1e-3, 1e3)
units = st.none() | st.sampled_from(["g", "kPa"])
vectors = st.dictionaries(st.text(min_size=1, max_size=5), positive, min_size=1, max_size=4)
outcomes = st.one_of(
    st.builds(Label, st.text()),
    st.builds(Likelihood, vectors),
    st.builds(Posterior, vectors, st.none() | vectors, positive),
    st.builds(Reading, numbers, st.none() | positive, units),
    st.builds(Above, numbers, st.none() | positive, units),
    st.builds(Below, numbers, st.none() | positive, units),
    st.builds(Failed, st.text()),
)


@given(st.text(min_size=1), outcomes)
def test_round_trip_through_json(action: str, outcome: Any) -> None:
    """Any action and outcome come back from JSON as they were written."""
    assert parse_item(json.loads(json.dumps(format_item(action, outcome)))) == (action, outcome)


@pytest.mark.parametrize(
    ("item", "outcome"),
    [
        ({"action": "a", "label": "mug"}, Label("mug")),
        ({"action": "a", "likelihood": {"glass": 1}}, Likelihood({"glass": 1.0})),
        (
            {"action": "a", "posterior": {"glass": 1}, "training_prior": {"glass": 1}, "temperature": 2},
            Posterior({"glass": 1.0}, {"glass": 1.0}, 2.0),
        ),
        ({"action": "a", "value": 118, "unit": "g"}, Reading(118.0, unit="g")),
        ({"action": "a", "value": 118, "sd": 2}, Reading(118.0, 2.0)),
        ({"action": "a", "above": 95, "unit": "kPa"}, Above(95.0, unit="kPa")),
        ({"action": "a", "below": 5}, Below(5.0)),
        ({"action": "a", "failed": True}, Failed()),
        ({"action": "a", "failed": True, "reason": "slipped"}, Failed("slipped")),
    ],
)
def test_each_kind_is_read(item: Any, outcome: Any) -> None:
    """Each kind of outcome has its key."""
    assert parse_item(item) == ("a", outcome)


@pytest.mark.parametrize(
    ("item", "told"),
    [
        ([], r"\[\] was found, expected an object"),
        ({"label": "mug"}, "no 'action' was found"),
        ({"action": 3, "label": "mug"}, "action 3 was found, expected text"),
        ({"action": "a"}, "no outcome of action 'a' was found: choose from 'label'"),
        ({"action": "a", "label": "mug", "value": 3}, "both 'label' and 'value'"),
        ({"action": "a", "label": "mug", "sd": 3}, "unknown key 'sd' beside 'label': choose from 'action', 'label'"),
        ({"action": "a", "value": 3, "units": "g"}, "unknown key 'units'"),
        ({"action": "a", "likelihood": {"x": 1}, "temperature": 2}, "unknown key 'temperature' beside 'likelihood'"),
        ({"action": "a", "label": 3}, "label 3 was found, expected text"),
        ({"action": "a", "value": "3"}, "value '3' was found, expected a number"),
        ({"action": "a", "value": True}, "value True was found, expected a number"),
        ({"action": "a", "value": None}, "value None was found, expected a number"),
        ({"action": "a", "value": 3, "sd": "1"}, "sd '1' was found"),
        ({"action": "a", "value": 3, "unit": 1}, "unit 1 was found, expected text"),
        ({"action": "a", "likelihood": [1, 2]}, "likelihood .* expected an object of names and numbers"),
        ({"action": "a", "posterior": {"x": "y"}}, "x 'y' was found, expected a number"),
        ({"action": "a", "failed": False}, "failed False was found, expected true"),
    ],
)
def test_bad_item_is_one_sentence(item: Any, told: str) -> None:
    """What cannot be read is an EvidenceError of one sentence that says what would be right."""
    with pytest.raises(EvidenceError, match=told) as caught:
        parse_item(item)
    assert "\n" not in str(caught.value)
