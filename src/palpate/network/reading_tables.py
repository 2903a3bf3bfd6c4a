"""What sections of a network file share: distributions, a row per parent configuration, CSV, units."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.errors import NetworkError
from palpate.network.document import Layer, Section, is_number
from palpate.network.properties import CategoricalProperty
from palpate.network.units import UnitError, unit_of

__all__ = ["configurations", "read_columns", "read_csv", "read_distribution", "read_unit"]

Array = NDArray[np.float64]
SUM_TOLERANCE = 1e-6


def read_distribution(section: Section, key: str, names: Sequence[str]) -> Array:
    """Probabilities of `names`: a list in their order, or a table by name (missing ones are 0)."""
    value = section.need(key, f"probabilities of {', '.join(names)}")
    if isinstance(value, Mapping):
        table = section.section(key)
        table.only(names, "name")
        numbers: list[object] = [table.tables.get(name, 0.0) for name in names]
    elif isinstance(value, list):
        numbers = value
    else:
        raise section.error(f"found {value!r}; expected a list of probabilities or a table by name", key)
    if len(numbers) != len(names):
        problem = f"found {len(numbers)} probabilities; expected {len(names)}, for {', '.join(names)}"
        raise section.error(problem, key)
    return _normalised(section, key, numbers)


def _normalised(section: Section, key: str, numbers: Sequence[object]) -> Array:
    probabilities = []
    for number in numbers:
        if not is_number(number) or number < 0:
            raise section.error(f"found {number!r}; expected probabilities from 0 to 1", key)
        probabilities.append(float(number))
    total = math.fsum(probabilities)
    if abs(total - 1) > SUM_TOLERANCE:
        raise section.error(f"found probabilities that sum to {total:.6g}; expected a sum of 1", key)
    return np.array(probabilities) / total


def configurations(
    section: Section, parents: Sequence[CategoricalProperty], what: str, key: str = "given"
) -> Iterator[tuple[Section, str]]:
    """Where the entry of each parent configuration stands, the last parent running fastest.

    The table ``given`` is nested once per parent: ``given.mug.large`` for category and size.
    """
    yield from _entries(section, key, list(parents), what)


def _entries(
    section: Section, key: str, parents: list[CategoricalProperty], what: str
) -> Iterator[tuple[Section, str]]:
    if not parents:
        yield section, key
        return
    first, *rest = parents
    table = section.section(key, f"a table with {what} for each state of {first.name!r}")
    table.only(first.states, f"state of {first.name!r}")
    for state in first.states:
        if state not in table:
            raise table.error(f"found no {state!r}; expected {what} for each state of {first.name!r}")
        yield from _entries(table, state, rest, what)


def read_columns(section: Section, truth: CategoricalProperty, outcomes: Sequence[str]) -> Array:
    """P(outcome | state), outcomes x states, from ``given``: a distribution for each true state."""
    entries = configurations(section, [truth], "probabilities of the outcomes")
    return np.stack([read_distribution(where, key, outcomes) for where, key in entries], axis=1)


def read_csv(section: Section, key: str, states: Sequence[str]) -> tuple[tuple[str, ...], Array]:
    """Outcomes and P(outcome | state), outcomes x states, from the CSV file that the key names.

    The first line names the true states (its first cell is free), in any order; each further line
    is an outcome and its probabilities. Columns sum to one.
    """
    path = Path(section.text(key))
    try:
        return _read_table(path, states)
    except NetworkError as error:
        raise section.error(f"found a table that cannot be used: {error}", key) from None


def _read_table(path: Path, states: Sequence[str]) -> tuple[tuple[str, ...], Array]:
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.reader(file, skipinitialspace=True) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise NetworkError(f"{path}: found no readable CSV file ({error}); expected a confusion matrix") from None
    if not rows or sorted(rows[0][1:]) != sorted(states):
        found = ", ".join(rows[0][1:]) if rows else "nothing"
        raise NetworkError(f"{path}: line 1: found {found}; expected each true state once: {', '.join(states)}")
    if long := next((row for row in rows if len(row) > len(rows[0])), None):
        raise NetworkError(f"{path}: row {long[0]!r}: found {len(long)} cells; expected {len(rows[0])}, as in line 1")
    outcomes = [row[0] for row in rows[1:]]
    if not outcomes or len(set(outcomes)) < len(outcomes):
        raise NetworkError(f"{path}: column 1: found {', '.join(outcomes) or 'nothing'}; expected each outcome once")
    section = _as_section(path, rows)
    columns = [read_distribution(section, state, outcomes) for state in states]
    return tuple(outcomes), np.stack(columns, axis=1)


def _as_section(path: Path, rows: Sequence[Sequence[str]]) -> Section:
    """The columns of a CSV file, so that they are checked as those of a TOML file."""
    columns: dict[str, object] = {}
    for index, state in enumerate(rows[0][1:], start=1):
        columns[state] = [_cell(path, row, index) for row in rows[1:]]
    return Section(columns, [Layer(str(path), columns)])


def _cell(path: Path, row: Sequence[str], index: int) -> float:
    try:
        return float(row[index])
    except (IndexError, ValueError):
        found = repr(row[index]) if index < len(row) else "nothing"
        raise NetworkError(f"{path}: row {row[0]!r}, column {index + 1}: found {found}; expected a number") from None


def read_unit(section: Section) -> str:
    """The unit of a property, which must be known."""
    unit = section.text("unit")
    try:
        unit_of(unit)
    except UnitError as error:
        raise section.error(f"found an {error}", "unit") from None
    return unit
