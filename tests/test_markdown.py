"""Tables in Markdown."""

import re
from math import nan

from hypothesis import given
from hypothesis import strategies as st

from palpate.markdown import Markdown, cell, table


def test_numbers_stand_to_the_right_and_what_is_missing_is_a_dash() -> None:
    """A column with any number in it is one of numbers; not a number is missing."""
    lines = table(["a", "b"], [["x", nan], ["y", 1.0]], digits=1).splitlines()
    assert lines[1:] == ["| --- | ---: |", "| x | - |", "| y | 1.0 |"]


def test_markdown_stands_as_it_is() -> None:
    """What is Markdown already acts as such, and other text does not."""
    assert table(["a"], [[Markdown("**a**")], ["**a**"]]).splitlines()[2:] == ["| **a** |", r"| \*\*a\*\* |"]


@given(st.lists(st.tuples(st.text(), st.text()), max_size=5), st.integers(0, 4))
def test_any_table_keeps_its_shape(rows: list[tuple[str, str]], most: int) -> None:
    """A table has a line for each row that is shown, and one for the rest."""
    lines = table(["a", "b"], rows, most=most).split("\n")
    assert len(lines) == 2 + min(len(rows), most) + (len(rows) > most)
    assert all(len(re.findall(r"(?<!\\)(?:\\\\)*\|", line)) == 3 for line in lines)
    assert all("\n" not in cell(part) for row in rows for part in row)
