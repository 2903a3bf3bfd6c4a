"""Counts beside estimated numbers: how often what was seen. They are checked, and are no part of the model."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.network.document import Section, is_number
from palpate.network.properties import CategoricalProperty
from palpate.network.reading_tables import configurations

__all__ = ["TALLIES", "check_counts", "check_tallies"]

TALLIES = ("objects", "readings")
"""What is counted for a sensor of a number."""


def check_counts(section: Section, parents: Sequence[CategoricalProperty], length: int | None = None) -> None:
    """Refuse ``counts`` that do not hold, for each configuration of the parents, a count or a list of them.

    Parameters
    ----------
    length
        Of each list; None where there is one count for each configuration.
    """
    if "counts" not in section:
        return
    what = "a count" if length is None else f"{length} counts"
    for where, key in configurations(section, parents, what, "counts"):
        value = where.need(key, what)
        counts = [value] if length is None else value
        if not isinstance(counts, list) or len(counts) != (length or 1) or not all(map(_is_count, counts)):
            raise where.error(f"found {value!r}; expected {what}: whole numbers, zero or above", key)


def check_tallies(section: Section) -> None:
    """Refuse ``counts`` of a sensor of a number other than of objects and readings."""
    if "counts" not in section:
        return
    table = section.section("counts", "a table with counts of objects and readings")
    table.only(TALLIES)
    for key in table:
        if not _is_count(table.tables[key]):
            raise table.error(f"found {table.tables[key]!r}; expected a whole number, zero or above", key)


def _is_count(value: object) -> bool:
    return is_number(value) and isinstance(value, int) and value >= 0
