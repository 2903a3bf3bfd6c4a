"""Data from CSV tables: one of objects with a column for each property, and one of readings."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate.errors import EvidenceError, choices, near
from palpate.fitting.csv_rows import Row, read_rows
from palpate.fitting.data import Data, Source, true_value, unit_factor
from palpate.fitting.errors import FittingError
from palpate.fitting.gathering import Gathered
from palpate.network.admission import admit
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Above, Below, Failed, Label, Outcome, Reading

__all__ = ["Column", "read_tables"]

OBJECT = "object"
READINGS = (OBJECT, "action", "outcome")
NAMED = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*", re.DOTALL)
NUMBER = re.compile(r"(?:(?P<side>above|below|>|<)\s*)?(?P<number>\S+)(?:\s+(?P<unit>.+))?", re.DOTALL)


@dataclass(frozen=True)
class Column:
    """What a column holds: a property, None where it is to be left out, and its unit, None where it is the property's.

    Examples
    --------
    >>> Column.parse("mass [kg]")
    Column(property='mass', unit='kg')
    """

    property: str | None
    unit: str | None = None

    @classmethod
    def parse(cls, text: str) -> Column:
        """Read ``NAME`` or ``NAME [UNIT]``; an empty text is a column that is left out."""
        found = NAMED.fullmatch(text.strip())
        assert found is not None
        return cls(found["name"] or None, found["unit"])


def read_tables(
    network: Network, objects: Path, readings: Path | None = None, columns: Mapping[str, Column] | None = None
) -> Data:
    """Read objects, and readings of them.

    Parameters
    ----------
    network
        What properties, states and actions there are.
    objects
        A line for each object: ``object``, its name, where there are readings, and a column for each property that is
        known, as ``material`` or ``mass [kg]``. What is empty is not known.
    readings
        A line for each reading: ``object``, ``action``, ``outcome``. An outcome is a label, a number, ``above 95`` or
        ``> 95``, ``below 5`` or ``< 5``, a number with a unit, as ``0.2 kg``, or ``failed``.
    columns
        What columns of `objects` hold whose names do not say so.

    Raises
    ------
    FittingError
        Naming the file, the line and the column: unknown columns, states, objects, actions and labels, what is no
        number, a number outside the support, a unit of another dimension, an object that comes twice.
    """
    gathered = Gathered(network)
    lines, source = _read_objects(gathered, objects, columns or {})
    sources = [source]
    if readings is not None:
        header, rows, more = read_rows(readings)
        places = _places(header)
        for row in rows:
            _read_reading(gathered, row, places, lines, objects)
        sources.append(more)
    return gathered.data(sources)


# Objects ----------------------------------------------------------------------------------------


def _read_objects(gathered: Gathered, path: Path, columns: Mapping[str, Column]) -> tuple[dict[str, int], Source]:
    header, rows, source = read_rows(path)
    named = _columns(gathered.network, header, columns)
    lines: dict[str, int] = {}
    for row in rows:
        name = row.cells[header.cells.index(OBJECT)] if OBJECT in header.cells else f"line {row.line:06d}"
        if not name:
            raise row.error(OBJECT, "found no name; expected one for each object")
        if name in lines:
            raise row.error(OBJECT, f"found {name!r}, as in line {lines[name]}; expected a line for each object")
        lines[name] = row.line
        gathered.know(name, dict(_known(gathered.network, row, header.cells, named)))
    return lines, source


def _columns(network: Network, header: Row, given: Mapping[str, Column]) -> Mapping[int, Column]:
    """What each column holds, by its place; columns that are left out are not there."""
    for name in given:
        if name not in header.cells:
            problem = f"found no column {name!r}{near(name, header.cells)}"
            raise FittingError(f"{header.file}: line 1: {problem}; {choices(header.cells)}")
    found: dict[int, Column] = {}
    for place, name in enumerate(header.cells):
        column = given.get(name, Column.parse(name))
        if name == OBJECT and name not in given:
            continue
        if column.property is not None:
            _check_column(network, header, name, column, [other.property for other in found.values()])
            found[place] = column
    return found


def _check_column(network: Network, header: Row, name: str, column: Column, others: Sequence[str | None]) -> None:
    if column.property is None or column.property not in network.properties:
        hint = near(column.property, network.properties)
        wanted = choices([OBJECT, *network.properties])
        raise header.error(
            name, f"found no property {column.property!r}{hint}; {wanted}, or say with --column what it holds"
        )
    if column.property in others:
        raise header.error(name, f"found a second column of {column.property!r}; expected one")
    prop = network.property(column.property)
    if column.unit is None:
        return
    if isinstance(prop, CategoricalProperty):
        raise header.error(name, f"found the unit {column.unit!r} of {prop.name!r}, which has states; expected none")
    try:
        unit_factor(column.unit, prop.unit)
    except FittingError as error:
        raise header.error(name, error) from None


def _known(
    network: Network, row: Row, header: Sequence[str], columns: Mapping[int, Column]
) -> Iterator[tuple[str, str | float]]:
    for place, column in columns.items():
        text = row.cells[place]
        if not text:
            continue
        assert column.property is not None
        prop = network.property(column.property)
        try:
            value = text if isinstance(prop, CategoricalProperty) else _number(text)
            yield prop.name, true_value(prop, value, column.unit)
        except FittingError as error:
            raise row.error(header[place], error) from None


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise FittingError(f"found {text!r}; expected a number, with a point, or nothing") from None


# Readings ---------------------------------------------------------------------------------------


def _places(header: Row) -> Mapping[str, int]:
    for name in header.cells:
        if name not in READINGS:
            raise header.error(name, f"found an unknown column{near(name, READINGS)}; {choices(READINGS)}")
    for name in READINGS:
        if name not in header.cells:
            raise FittingError(f"{header.file}: line 1: found no column {name!r}; expected {', '.join(READINGS)}")
    return {name: header.cells.index(name) for name in READINGS}


def _read_reading(
    gathered: Gathered, row: Row, places: Mapping[str, int], objects: Mapping[str, int], file: Path
) -> None:
    thing, action, text = (row.cells[places[name]] for name in READINGS)
    if thing not in objects:
        raise row.error(OBJECT, f"found {thing!r}{near(thing, objects)}; expected an object of {file}")
    network = gathered.network
    if action not in network.actions:
        raise row.error("action", f"found {action!r}{near(action, network.actions)}; {choices(network.actions)}")
    try:
        number = not isinstance(network.actions[action].sensor, ConfusionSensor)
        admitted = admit(network, action, _outcome(text, number))
    except (EvidenceError, FittingError) as error:
        raise row.error("outcome", error) from None
    for notice in admitted.notices:
        gathered.tell(notice)
    gathered.measure(thing, action, admitted.outcome)


def _outcome(text: str, number: bool) -> Outcome:
    if text in ("", "failed"):
        return Failed()
    if not number:
        return Label(text)
    found = NUMBER.fullmatch(text)
    assert found is not None
    value, unit = _number(found["number"]), found["unit"]
    if found["side"] in ("above", ">"):
        return Above(value, unit=unit)
    if found["side"] in ("below", "<"):
        return Below(value, unit=unit)
    return Reading(value, unit=unit)
