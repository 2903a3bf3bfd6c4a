"""Tables in Markdown."""

from math import nan

from palpate.experiments.markdown import table


def test_numbers_stand_to_the_right_and_what_is_missing_is_a_dash() -> None:
    """A column with any number in it is one of numbers; not a number is missing."""
    lines = table(["a", "b"], [["x", nan], ["y", 1.0]], digits=1).splitlines()
    assert lines[1:] == ["| --- | ---: |", "| x | - |", "| y | 1.0 |"]
