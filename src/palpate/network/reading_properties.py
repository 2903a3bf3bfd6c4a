"""The ``properties`` of a network file; derived ones are read in `palpate.network.reading_derived`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from palpate.errors import choices
from palpate.network.document import Section, refuse_cycle, unknown
from palpate.network.families import Family, Gamma, LogNormal, Normal, StudentT, Uniform
from palpate.network.model import MAX_JOINT_STATES
from palpate.network.properties import CategoricalProperty, ContinuousProperty, Property
from palpate.network.reading_counts import check_counts
from palpate.network.reading_derived import read_derived
from palpate.network.reading_tables import configurations, read_distribution, read_unit

__all__ = ["FAMILIES", "RESERVED", "read_properties"]

Array = NDArray[np.float64]
RESERVED = "everything"

FAMILIES: Mapping[str, tuple[Callable[..., Family], tuple[str, ...], tuple[str, ...]]] = {
    # name: (class, parameters above zero, other parameters)
    "normal": (Normal, ("sd",), ("mean",)),
    "truncated-normal": (Normal, ("sd",), ("mean", "low", "high")),
    "lognormal": (LogNormal, ("median", "log_sd"), ()),
    "gamma": (Gamma, ("shape", "scale"), ()),
    "uniform": (Uniform, (), ("low", "high")),
    "student-t": (StudentT, ("scale", "dof"), ("location",)),
}


def read_properties(document: Section) -> dict[str, Property]:
    """Every property in the order of the file, checked against each other."""
    sections = document.sections("properties")
    if not sections:
        raise document.error("found no properties; expected at least one table [properties.NAME]")
    if RESERVED in sections:
        raise sections[RESERVED].error(
            f"found the reserved name {RESERVED!r}; expected another, as it means all of them"
        )
    categorical = _read_categorical(document, {name: s for name, s in sections.items() if "states" in s})
    properties: dict[str, Property] = {}
    for name, section in sections.items():
        if name in categorical:
            properties[name] = categorical[name]
        elif "formula" not in section:
            properties[name] = _read_continuous(name, section, categorical, tuple(sections))
    formulas = {name: section for name, section in sections.items() if name not in properties}
    properties.update(read_derived(formulas, properties))
    return {name: properties[name] for name in sections}


def _parents(section: Section, categorical: Mapping[str, object], every: tuple[str, ...]) -> tuple[str, ...]:
    parents = section.names("parents", ())
    for parent in parents:
        if parent not in every:
            raise section.error(unknown("property", parent, list(categorical)), "parents")
        if parent not in categorical:
            problem = f"found {parent!r}, which is not categorical; {choices(categorical)}"
            raise section.error(problem, "parents")
    return parents


# Categorical properties -------------------------------------------------------------------------


def _read_categorical(document: Section, sections: Mapping[str, Section]) -> dict[str, CategoricalProperty]:
    every = tuple(document.sections("properties"))
    bare: dict[str, CategoricalProperty] = {}
    for name, section in sections.items():
        section.only(("description", "source", "states", "prior", "parents", "given", "counts"))
        states, parents = section.names("states"), _parents(section, sections, every)
        if not states:
            raise section.error("found no states; expected at least one", "states")
        bare[name] = CategoricalProperty(name, states, parents, np.empty(0))
    joint = math.prod(len(p.states) for p in bare.values())
    if joint > MAX_JOINT_STATES:
        problem = f"found {joint} joint states of the categorical properties; expected at most {MAX_JOINT_STATES}"
        raise document.error(problem, "properties")
    refuse_cycle(sections, {name: p.parents for name, p in bare.items()}, "parents")
    return {name: replace(p, table=_read_table(sections[name], p, bare)) for name, p in bare.items()}


def _read_table(section: Section, prop: CategoricalProperty, bare: Mapping[str, CategoricalProperty]) -> Array:
    check_counts(section, [bare[name] for name in prop.parents], len(prop.states))
    if not prop.parents:
        _refuse(section, "given", "prior")
        if "prior" not in section:
            return np.full(len(prop.states), 1 / len(prop.states))
        return read_distribution(section, "prior", prop.states)
    _refuse(section, "prior", "given")
    parents = [bare[name] for name in prop.parents]
    entries = configurations(section, parents, f"probabilities of {prop.name!r}")
    rows = [read_distribution(where, key, prop.states) for where, key in entries]
    return np.reshape(rows, [len(p.states) for p in (*parents, prop)])


def _refuse(section: Section, key: str, instead: str) -> None:
    if key in section:
        parents = "without" if key == "given" else "with"
        raise section.error(f"found {key!r} in a property {parents} parents; expected {instead!r}", key)


# Continuous properties --------------------------------------------------------------------------


def _read_continuous(
    name: str, section: Section, categorical: Mapping[str, CategoricalProperty], every: tuple[str, ...]
) -> ContinuousProperty:
    if "family" not in section:
        raise section.error("found neither 'states' nor 'family' nor 'formula'; expected one of them")
    family = section.text("family")
    if family not in FAMILIES:
        raise section.error(unknown("family", family, list(FAMILIES)), "family")
    build, positive, other = FAMILIES[family]
    parameters = (*other, *positive)
    section.only(("description", "source", "unit", "family", "parents", "given", "counts", *parameters))
    unit, parents = read_unit(section), [categorical[p] for p in _parents(section, categorical, every)]
    check_counts(section, parents)
    if not parents:
        _refuse(section, "given", "the parameters in the property itself")
    rows = [
        _parameters(row, parameters, positive) for row in _rows(section, parents, parameters, f"parameters of {name!r}")
    ]
    shape = [len(p.states) for p in parents]
    columns = {key: np.reshape([row[key] for row in rows], shape) for key in parameters}
    if family == "normal":
        columns |= {"low": np.full(shape, -np.inf), "high": np.full(shape, np.inf)}
    return ContinuousProperty(name, unit, tuple(p.name for p in parents), build(**columns))


def _rows(
    section: Section, parents: list[CategoricalProperty], parameters: tuple[str, ...], what: str
) -> Iterator[Section]:
    """A section of parameters per configuration; those of the property itself hold for all."""
    shared = {key: section.tables[key] for key in parameters if key in section}
    if not parents:
        yield section
        return
    if "given" not in section and len(shared) == len(parameters):
        raise section.error("found parents but no 'given'; expected parameters for each of their states")
    for where, key in configurations(section, parents, what):
        row = where.section(key, what)
        row.only(parameters, "parameter")
        yield replace(row, tables={**shared, **row.tables})


def _parameters(row: Section, parameters: tuple[str, ...], positive: tuple[str, ...]) -> dict[str, float]:
    """The parameters of one configuration, in the property's unit."""
    ends = {"low": -math.inf, "high": math.inf} if "mean" in parameters else {}
    values = {key: row.positive(key) if key in positive else row.number(key, ends.get(key)) for key in parameters}
    if "low" in values:
        if math.isinf(values["low"]) and math.isinf(values["high"]):
            raise row.error("found neither 'low' nor 'high'; expected one of them, or family 'normal'")
        if values["low"] >= values["high"]:
            key = "high" if "high" in row else "low"
            problem = f"found low {values['low']:g} and high {values['high']:g}; expected low below high"
            raise row.error(problem, key)
    return values
