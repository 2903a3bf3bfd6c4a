"""The network that a fit keeps: properties, parents, families, actions and costs; numbers may be left out of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from palpate.network.digest import digest
from palpate.network.model import Network
from palpate.network.reading import network_of, read_document

__all__ = ["Template", "read_template"]

PLACEHOLDERS: Mapping[str, Mapping[str, float]] = {
    "normal": {"mean": 0.0, "sd": 1.0},
    "truncated-normal": {"mean": 0.0, "sd": 1.0},
    "lognormal": {"median": 1.0, "log_sd": 1.0},
    "gamma": {"shape": 1.0, "scale": 1.0},
    "student-t": {"location": 0.0, "scale": 1.0},
}
"""Family to the parameters that are estimated; all others are kept as they are."""
SCALES = {"normal": ("sd", "relative_sd"), "student-t": ("scale", "relative_scale")}


@dataclass(frozen=True)
class Template:
    """A network to be fitted.

    Attributes
    ----------
    network
        With stand-ins where numbers were left out.
    tables
        As in its file, with the files that it extends in it.
    blank_properties, blank_actions
        Names of those whose numbers were left out: they are no prior to compare with.
    """

    network: Network
    tables: Mapping[str, Any]
    blank_properties: frozenset[str] = frozenset()
    blank_actions: frozenset[str] = frozenset()

    @property
    def digest(self) -> str:
        """That of the network."""
        return digest(self.network)


def read_template(name_or_path: str | Path) -> Template:
    """Read a template: a network as `palpate.network.reading` has it, out of which numbers may be left.

    A categorical property with parents needs no ``given``, a continuous one no parameters but limits and degrees of
    freedom, a sensor no confusion matrix and no SD.

    Raises
    ------
    NetworkError
        As `palpate.network.reading.load_network`.
    """
    document = read_document(name_or_path)
    tables: dict[str, Any] = {**document.tables}
    tables.pop("extends", None)
    states = {
        name: prop["states"] for name, prop in _tables(tables.get("properties")) if isinstance(prop.get("states"), list)
    }
    blank_properties = _fill(tables, "properties", lambda table: _with_numbers(table, states))
    blank_actions = _fill(tables, "actions", lambda table: _with_sensor(table, states))
    return Template(network_of(replace(document, tables=tables)), tables, blank_properties, blank_actions)


def _fill(tables: dict[str, Any], key: str, fill: Callable[[Mapping[str, Any]], Mapping[str, Any]]) -> frozenset[str]:
    """Put stand-ins into the tables of a group; the names of those that got some."""
    if not isinstance(tables.get(key), Mapping):
        return frozenset()
    filled = {name: fill(table) for name, table in _tables(tables[key])}
    blank = frozenset(name for name, table in filled.items() if table is not tables[key][name])
    tables[key] = {**tables[key], **filled}
    return blank


def _tables(group: Any) -> list[tuple[str, Mapping[str, Any]]]:
    if not isinstance(group, Mapping):
        return []
    return [(name, table) for name, table in group.items() if isinstance(table, Mapping)]


def _with_numbers(table: Mapping[str, Any], states: Mapping[str, Any]) -> Mapping[str, Any]:
    """A property with stand-ins where no numbers are given; the very same where some are."""
    parents = table.get("parents", [])
    known = isinstance(parents, list) and all(isinstance(name, str) and name in states for name in parents)
    if "given" in table or not known:
        return table
    if "states" in table:
        return {**table, "given": _rows(parents, states, _uniform(table["states"]))} if parents else table
    parameters = PLACEHOLDERS.get(str(table.get("family")), {})
    if not parameters or any(key in table for key in parameters):
        return table
    return {**table, "given": _rows(parents, states, dict(parameters))} if parents else {**table, **parameters}


def _with_sensor(table: Mapping[str, Any], states: Mapping[str, Any]) -> Mapping[str, Any]:
    """An action whose sensor has stand-ins where no numbers are given."""
    sensor = table.get("sensor")
    if not isinstance(sensor, Mapping):
        return table
    measured, kind = sensor.get("property"), sensor.get("kind")
    if kind == "confusion" and not {"given", "csv"} & set(sensor) and isinstance(measured, str) and measured in states:
        row = _uniform(sensor.get("outcomes", states[measured]))
        return {**table, "sensor": {**sensor, "given": _rows([measured], states, row)}}
    if kind in SCALES and not set(SCALES[kind]) & set(sensor):
        return {**table, "sensor": {**sensor, SCALES[kind][0]: 1.0}}
    return table


def _uniform(names: Any) -> list[float]:
    count = len(names) if isinstance(names, list) else 0
    return [1 / count] * count if count else []


def _rows(parents: list[str], states: Mapping[str, Any], row: object) -> Any:
    """The row for each configuration of the parents, nested in their order."""
    if not parents:
        return row
    first, *rest = parents
    return {state: _rows(rest, states, row) for state in states[first] if isinstance(state, str)}
