import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, FieldPath
from tests.store.importing.bags.made import joints, ns

ARM = joints(ns(0), ["joint_1", "joint-2/left"], [0.5, 1.5])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("effort[joint_1]", 0.5),
        ("effort[joint-2/left]", 1.5),
        ("effort[1]", 1.5),
        ("header.stamp.sec", 1_714_566_615),
        ("name[0]", "joint_1"),
    ],
)
def test_fields_are_found(text: str, value: object) -> None:
    """A path goes into messages, and into arrays by place and by the names beside them."""
    assert FieldPath.parse(text).of(ARM) == value


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("efort[joint_1]", r"no field 'efort' \(did you mean 'effort'\?\)"),
        ("effort[joint_3]", r"named 'joint_3' \(did you mean 'joint_1'\?\); choose from 'joint_1'"),
        ("effort[2]", "2 elements, too few for"),
        ("position[joint_1]", "0 elements, too few"),
        ("effort.size", "it has no fields"),
        ("header.stamp[a]", "no names beside it|nothing in"),
    ],
)
def test_what_is_not_there_is_missing_with_a_reason(text: str, told: str) -> None:
    """A path that leads nowhere gives `MISSING`, and what would be right; attributes of Python are no fields."""
    path = FieldPath.parse(text)
    assert path.of(ARM) is MISSING
    with pytest.raises(StoreError, match=told):
        raise StoreError(path.complaint(ARM))


def test_names_may_stand_further_out() -> None:
    """Names that stand beside an outer message name the elements of arrays in it."""
    state = {"joint_names": ["a", "b"], "actual": {"effort": [1, 2]}}
    assert FieldPath.parse("actual.effort[b]").of(state) == 2


def test_digits_in_quotes_are_a_name() -> None:
    """A name of digits is told from a place by quotes."""
    message = {"name": ["1", "0"], "effort": [10.0, 20.0]}
    assert FieldPath.parse("effort[0]").of(message) == 10.0
    assert FieldPath.parse("effort['0']").of(message) == 20.0


def test_fields_with_names_of_keywords_are_found() -> None:
    """A field that is called as a keyword of Python is found under its own name."""
    message = type("Message", (), {})()
    message.__dict__["from_"] = 3
    assert FieldPath.parse("from").of(message) == 3


@pytest.mark.parametrize("text", ["", ".", "a.", "a..b", "a[", "a[]", "a[0", "a b", "a[0][1]", "0a"])
def test_what_is_no_path_is_refused(text: str) -> None:
    """A text of another form is refused with an example."""
    with pytest.raises(StoreError, match=r"expected one such as 'wrench\.force\.x'"):
        FieldPath.parse(text)


@given(st.lists(st.from_regex(r"[a-z_][a-z0-9_]{0,5}", fullmatch=True), min_size=1, max_size=4), st.integers())
def test_any_nesting_is_followed(names: list[str], value: int) -> None:
    """The value that was put under a path of names is the one found there."""
    message: object = value
    for name in reversed(names):
        message = {name: message}
    assert FieldPath.parse(".".join(names)).of(message) == value
