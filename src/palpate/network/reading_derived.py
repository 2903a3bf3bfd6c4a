"""The derived properties of a network file: formulas over quantities, checked and put in units."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.errors import NetworkError
from palpate.network.document import Section, refuse_cycle, unknown
from palpate.network.formula import Formula
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property
from palpate.network.reading_tables import read_unit
from palpate.network.units import UnitError, in_units

__all__ = ["MAX_GROUP", "read_derived"]

MAX_GROUP = 3
"""Continuous properties that derived ones may couple: each adds a dimension to the quadrature."""


def read_derived(sections: Mapping[str, Section], others: Mapping[str, Property]) -> dict[str, DerivedProperty]:
    """The derived properties; `others` are the categorical and continuous ones."""
    parsed = {name: _read_formula(section, {**others, **sections}) for name, section in sections.items()}
    inner = {name: tuple(v for v in f.variables if v in sections) for name, f in parsed.items()}
    refuse_cycle(sections, inner, "formula")
    units = {name: read_unit(section) for name, section in sections.items()}
    units |= {name: p.unit for name, p in others.items() if isinstance(p, ContinuousProperty)}
    flat: dict[str, Formula] = {}

    def flatten(name: str) -> Formula:
        if name not in flat:
            try:
                own = in_units(parsed[name], units, units[name])
            except UnitError as error:
                raise sections[name].error(f"found a mismatch of units: {error}", "formula") from None
            flat[name] = own.substituted({v: flatten(v) for v in inner[name]})
        return flat[name]

    derived = {name: DerivedProperty(name, units[name], flatten(name)) for name in sections}
    _check_solvable(sections, derived)
    _check_groups(sections, derived)
    return derived


def _read_formula(section: Section, names: Mapping[str, object]) -> Formula:
    section.only(("description", "source", "unit", "formula"))
    try:
        formula = Formula.parse(section.text("formula"))
    except NetworkError as error:
        raise section.error(f"found a {error}", "formula") from None
    numbers = [name for name, p in names.items() if not isinstance(p, CategoricalProperty)]
    for variable in formula.variables:
        if variable not in numbers:
            raise section.error(unknown("property", variable, numbers), "formula")
    if not formula.variables:
        raise section.error(f"found {formula.text!r}; expected a formula over properties", "formula")
    return formula


def _check_solvable(sections: Mapping[str, Section], derived: Mapping[str, DerivedProperty]) -> None:
    """A measurement of a derived property is used by solving its formula for one of its variables."""
    for name, prop in derived.items():
        if not prop.formula.solvable():
            variables = ", ".join(prop.formula.variables)
            problem = f"found {prop.formula.text!r}, in which each of {variables} occurs more than once"
            expected = "expected at least one that occurs once, so that it can be inverted"
            raise sections[name].error(f"{problem}; {expected}", "formula")


def _check_groups(sections: Mapping[str, Section], derived: Mapping[str, DerivedProperty]) -> None:
    """Continuous properties that derived ones link are integrated together: keep them few."""
    groups: list[set[str]] = []
    for name, prop in derived.items():
        linked = set(prop.formula.variables).union(*(g for g in groups if g & set(prop.formula.variables)))
        groups = [g for g in groups if not g & linked] + [linked]
        if len(linked) > MAX_GROUP:
            names = ", ".join(sorted(linked))
            problem = f"found a formula that links {len(linked)} continuous properties ({names})"
            raise sections[name].error(f"{problem}; expected at most {MAX_GROUP}", "formula")
