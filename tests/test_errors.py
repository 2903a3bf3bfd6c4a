import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.errors import near

NAMES = ["banana", "Banana_ycb", "mug"]


@pytest.mark.parametrize(
    ("found", "meant"),
    [
        ("banan", "banana"),
        ("BANANA", "banana"),
        ("banana-ycb", "Banana_ycb"),
        ("muug", "mug"),
        ("lamp", None),
        ("rug", None),
        ("", None),
        (3, None),
    ],
)
def test_a_near_name_is_proposed(found: object, meant: str | None) -> None:
    """The valid name closest to a wrong one is proposed, whatever its case, and none where none is near."""
    assert near(found, NAMES) == (f" (did you mean {meant!r}?)" if meant else "")


@given(st.text(), st.lists(st.text()))
def test_what_is_proposed_is_valid(found: str, names: list[str]) -> None:
    """Whatever was found, only a valid name is ever proposed."""
    hint = near(found, names)
    assert hint in {"", *(f" (did you mean {name!r}?)" for name in names)}
