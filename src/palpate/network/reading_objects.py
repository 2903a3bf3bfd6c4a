"""The ``objects`` of a network file: objects with known true properties."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from palpate.errors import choices
from palpate.network.document import Section, unknown
from palpate.network.model import KnownObject, TrueValue
from palpate.network.properties import CategoricalProperty, DerivedProperty, Property

__all__ = ["STATUSES", "read_objects"]

STATUSES = ("measured", "assumed", "unknown")
AGREEMENT = 0.05
"""A derived true value may differ from its formula by this fraction: figures are rounded."""


def read_objects(document: Section, properties: Mapping[str, Property]) -> dict[str, KnownObject]:
    """Every known object in the order of the file."""
    sections = document.sections("objects")
    objects = {name: _read_object(name, section, properties) for name, section in sections.items()}
    for name, thing in objects.items():
        if thing.looks_like is not None and thing.looks_like not in objects:
            raise sections[name].error(unknown("object", thing.looks_like, list(objects)), "looks_like")
        if thing.looks_like == name:
            raise sections[name].error(
                f"found the object itself; {choices(o for o in objects if o != name)}", "looks_like"
            )
    return objects


def _read_object(name: str, section: Section, properties: Mapping[str, Property]) -> KnownObject:
    section.only(("description", "looks_like", "truth"))
    truth = section.section("truth", "a table with the true properties")
    truth.only(properties, "property")
    values = {}
    for prop in properties.values():
        if prop.name in truth or not isinstance(prop, DerivedProperty):
            values[prop.name] = _read_value(truth, prop)
    for prop in properties.values():
        if isinstance(prop, DerivedProperty):
            values[prop.name] = _derived(truth, prop, values)
    ordered = {key: values[key] for key in properties}
    looks_like = section.text("looks_like") if "looks_like" in section else None
    return KnownObject(name, section.text("description", ""), ordered, looks_like)


def _read_value(truth: Section, prop: Property) -> TrueValue:
    """A true value: a table {value, status, source}, or the value alone, which is then assumed."""
    raw = truth.need(prop.name, f"its true {prop.name}")
    if not isinstance(raw, Mapping):
        return TrueValue(_value(truth, prop.name, prop), "assumed")
    entry = truth.section(prop.name)
    entry.only(("value", "status", "source"))
    status, source = entry.text("status", "assumed"), entry.text("source", "")
    if status not in STATUSES:
        raise entry.error(unknown("status", status, STATUSES), "status")
    if status == "measured" and not source:
        raise entry.error(
            "found 'measured' without a source; expected 'source' to say where the value is from", "status"
        )
    return TrueValue(_value(entry, "value", prop), status, source)


def _value(section: Section, key: str, prop: Property) -> str | float:
    if not isinstance(prop, CategoricalProperty):
        return section.number(key)
    state = section.text(key)
    if state not in prop.states:
        raise section.error(unknown(f"state of {prop.name!r}", state, prop.states), key)
    return state


def _derived(truth: Section, prop: DerivedProperty, values: Mapping[str, TrueValue]) -> TrueValue:
    """The true value of a derived property: as given if it fits the formula, else from the formula."""
    inputs = [values[name] for name in prop.formula.variables]
    with np.errstate(all="ignore"):
        result = float(prop.formula.evaluate({n: float(values[n].value) for n in prop.formula.variables}))
    if not np.isfinite(result):
        raise truth.error(f"found {prop.name!r} = {prop.formula.text} = {result}; expected a finite number")
    given = values.get(prop.name)
    if given is None:
        # As little known as the least known of its inputs, and never measured itself.
        status = "unknown" if any(v.status == "unknown" for v in inputs) else "assumed"
        return TrueValue(result, status, prop.formula.text)
    if abs(float(given.value) - result) > AGREEMENT * abs(result):
        problem = f"found {given.value}, but {prop.formula.text} is {result:g}"
        raise truth.error(f"{problem}; expected the two to agree within {AGREEMENT:.0%}", prop.name)
    return given
