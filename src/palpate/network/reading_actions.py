"""The ``actions`` of a network file with their sensor models."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from palpate.errors import choices
from palpate.network.document import Section, unknown
from palpate.network.model import Action
from palpate.network.noises import NormalNoise, StudentTNoise
from palpate.network.properties import CategoricalProperty, Property
from palpate.network.reading_counts import check_counts, check_tallies
from palpate.network.reading_tables import read_columns, read_csv
from palpate.network.sensors import ConfusionSensor, NumberSensor, Sensor

__all__ = ["SENSORS", "read_actions"]

SENSORS: Mapping[str, tuple[str, ...]] = {
    "confusion": ("outcomes", "given", "csv", "repeat_probability"),
    "normal": ("sd", "relative_sd", "saturates_below", "saturates_above", "offset_sd", "bias"),
    "student-t": ("scale", "relative_scale", "dof", "saturates_below", "saturates_above", "offset_sd", "bias"),
}
"""The kinds of sensors and the keys of each, besides ``property`` and ``kind``."""


def read_actions(document: Section, properties: Mapping[str, Property]) -> dict[str, Action]:
    """Every action in the order of the file."""
    return {name: _read_action(name, s, properties) for name, s in document.sections("actions").items()}


def _read_action(name: str, section: Section, properties: Mapping[str, Property]) -> Action:
    section.only(("description", "cost_s", "cost_source", "sees_appearance", "sensor"))
    section.text("cost_source", "")
    return Action(
        name,
        section.between("cost_s", 0, 1e9),
        _read_sensor(section.section("sensor", "a table with the sensor model"), properties),
        section.flag("sees_appearance"),
        section.text("description", ""),
    )


def _read_sensor(section: Section, properties: Mapping[str, Property]) -> Sensor:
    name, kind = section.text("property"), section.text("kind")
    if name not in properties:
        raise section.error(unknown("property", name, list(properties)), "property")
    if kind not in SENSORS:
        raise section.error(unknown("kind of sensor", kind, list(SENSORS)), "kind")
    section.only(("property", "kind", "description", "source", "counts", *SENSORS[kind]))
    prop = properties[name]
    if (kind == "confusion") != isinstance(prop, CategoricalProperty):
        is_a = "is categorical" if isinstance(prop, CategoricalProperty) else "is a number"
        valid = [k for k in SENSORS if (k == "confusion") == isinstance(prop, CategoricalProperty)]
        raise section.error(f"found {kind!r} for {name!r}, which {is_a}; {choices(valid)}", "kind")
    return _read_confusion(section, prop) if isinstance(prop, CategoricalProperty) else _read_number(section, name)


def _read_confusion(section: Section, prop: CategoricalProperty) -> ConfusionSensor:
    if ("csv" in section) == ("given" in section):
        found = "both 'given' and 'csv'" if "csv" in section else "neither 'given' nor 'csv'"
        raise section.error(f"found {found}; expected one of them, with the confusion matrix")
    repeat = section.between("repeat_probability", 0, 1, 0.0)
    if "given" in section:
        outcomes = section.names("outcomes", prop.states)
        check_counts(section, [prop], len(outcomes))
        return ConfusionSensor(prop.name, outcomes, read_columns(section, prop, outcomes), repeat)
    found_outcomes, table = read_csv(section, "csv", prop.states)
    outcomes = section.names("outcomes", found_outcomes)
    if sorted(outcomes) != sorted(found_outcomes):
        problem = f"found {', '.join(outcomes)}; expected the rows of the CSV file: {', '.join(found_outcomes)}"
        raise section.error(problem, "outcomes")
    check_counts(section, [prop], len(outcomes))
    rows = [found_outcomes.index(outcome) for outcome in outcomes]
    return ConfusionSensor(prop.name, outcomes, np.asarray(table[rows]), repeat)


def _read_number(section: Section, name: str) -> NumberSensor:
    """A normal or Student t sensor; its numbers are in the property's unit."""
    check_tallies(section)
    normal = section.text("kind") == "normal"
    scale, relative = ("sd", "relative_sd") if normal else ("scale", "relative_scale")
    if scale not in section and relative not in section:
        raise section.error(f"found neither {scale!r} nor {relative!r}; expected at least one of them")
    low, high = section.number("saturates_below", -math.inf), section.number("saturates_above", math.inf)
    if low >= high:
        problem = f"found saturation below {low:g} and above {high:g}; expected the first to be the smaller one"
        raise section.error(problem, "saturates_above")
    return NumberSensor(
        name,
        sd=section.positive(scale, 0.0),
        relative_sd=section.positive(relative, 0.0),
        noise=NormalNoise() if normal else StudentTNoise(section.positive("dof")),
        low=low,
        high=high,
        offset_sd=section.between("offset_sd", 0, 1e300, 0.0),
        bias=section.number("bias", 0.0),
    )
