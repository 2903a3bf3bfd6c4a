"""A network fitted to data: its numbers estimated, all else kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from palpate.errors import plural
from palpate.fitting.data import Specimen
from palpate.fitting.densities import TOO_FEW as FEW_VALUES
from palpate.fitting.densities import fit_density
from palpate.fitting.errors import FittingError
from palpate.fitting.noise import TOO_FEW as FEW_READINGS
from palpate.fitting.noise import fit_noise
from palpate.fitting.parts import Fitted, PropertyPart, SensorPart
from palpate.fitting.repeats import repeat_probability
from palpate.fitting.settings import Settings
from palpate.fitting.tables import dirichlet_mean, labels_of, looks, state_counts
from palpate.fitting.template import Template
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, Property
from palpate.network.sensors import ConfusionSensor

__all__ = ["fit", "fit_property", "fit_sensor"]

KEPT = "as in the template: kept"
NOTHING = "as in the template: no data"
PLACES = 9
"""Decimal places of probabilities."""


def fit(template: Template, specimens: Sequence[Specimen], settings: Settings | None = None) -> Fitted:
    """Estimate the numbers of a network.

    Parameters
    ----------
    template
        What is kept, and what stays where there are no data.
    specimens
        Objects with known properties and readings; their order does not matter.

    Raises
    ------
    FittingError
        Numbers that the template leaves out cannot be estimated, or `settings` keeps what is not there.
    """
    settings = settings or Settings()
    network = template.network
    settings.check(network)
    ordered = sorted(specimens, key=lambda one: one.name)
    properties, actions = dict(network.properties), dict(network.actions)
    property_parts: dict[str, PropertyPart] = {}
    action_parts: dict[str, SensorPart] = {}
    own: list[CategoricalProperty | ContinuousProperty] = [*network.categorical, *network.continuous]
    for prop in own:
        properties[prop.name], part = fit_property(network, prop, ordered, settings)
        property_parts[prop.name] = part
        if part.counts is None and prop.name in template.blank_properties:
            raise _missing(
                prop.name, plural(part.objects, "value"), f"{FEW_VALUES} of objects with known {_names(prop)}"
            )
    for action in network.actions.values():
        actions[action.name], found = fit_sensor(network, action, ordered, settings)
        action_parts[action.name] = found
        if action.name in template.blank_actions and found.counts is None and found.bias is None:
            wanted = f"{FEW_READINGS} on objects with known {action.sensor.property}"
            raise _missing(action.name, plural(found.readings, "reading"), wanted)
    return Fitted(replace(network, properties=properties, actions=actions), property_parts, action_parts)


def _missing(name: str, found: str, wanted: str) -> FittingError:
    return FittingError(f"{name}: found {found}; expected at least {wanted}, as the template says nothing about it")


def _names(prop: ContinuousProperty | CategoricalProperty) -> str:
    return " and ".join([*prop.parents, prop.name])


def fit_property(
    network: Network, prop: CategoricalProperty | ContinuousProperty, specimens: Sequence[Specimen], settings: Settings
) -> tuple[Property, PropertyPart]:
    """Fit one property to specimens."""
    if prop.name in settings.keep:
        return prop, PropertyPart(None, note=KEPT)
    fitted, part = _fit_property(network, prop, specimens, settings)
    without = sum(prop.name in one.truth and not _placed(prop, one) for one in specimens)
    told = f"not used: {without} of objects whose {' or '.join(prop.parents)} is not known" if without else ""
    return fitted, replace(part, note="; ".join(note for note in (part.note, told) if note))


def _placed(prop: CategoricalProperty | ContinuousProperty, one: Specimen) -> bool:
    return all(parent in one.truth for parent in prop.parents)


def _fit_property(
    network: Network, prop: CategoricalProperty | ContinuousProperty, specimens: Sequence[Specimen], settings: Settings
) -> tuple[Property, PropertyPart]:
    if isinstance(prop, ContinuousProperty):
        fitted, part = fit_density(network, prop, specimens)
        return fitted, replace(part, note=NOTHING) if part.counts is None else part
    counts = state_counts(network, prop, specimens)
    objects = int(counts.sum())
    if not objects:
        return prop, PropertyPart(None, note=NOTHING)
    empty = int((counts.sum(axis=-1) == 0).sum())
    note = f"{empty} of {counts.size // len(prop.states)} rows without objects: uniform" if empty else ""
    table = np.round(dirichlet_mean(counts, settings.pseudo_count), PLACES)
    return replace(prop, table=table), PropertyPart(counts, objects, note=note)


def fit_sensor(
    network: Network, action: Action, specimens: Sequence[Specimen], settings: Settings
) -> tuple[Action, SensorPart]:
    """Fit the sensor of one action to specimens."""
    if action.name in settings.keep:
        return action, SensorPart(note=KEPT)
    fitted, part = _fit_sensor(network, action, specimens, settings)
    measured = action.sensor.property
    without = sum(len(one.readings.get(action.name, ())) for one in specimens if measured not in one.truth)
    told = f"not used: {without} of objects whose {measured} is not known" if without else ""
    return fitted, replace(part, note="; ".join(note for note in (part.note, told) if note))


def _fit_sensor(
    network: Network, action: Action, specimens: Sequence[Specimen], settings: Settings
) -> tuple[Action, SensorPart]:
    sensor = action.sensor
    if not isinstance(sensor, ConfusionSensor):
        noise, part = fit_noise(action.name, sensor, specimens, whole=settings.whole_sensors)
        return replace(action, sensor=noise), part if part.bias else replace(part, note=NOTHING)
    if settings.whole_sensors:
        repeats = repeat_probability(network, action.name, sensor, specimens)
        sensor = sensor if repeats is None else replace(sensor, repeat_probability=repeats)
    counts, weights = looks(network, action.name, sensor, specimens)
    if not counts.any():
        return action, SensorPart(note=NOTHING)
    table = np.round(dirichlet_mean(weights, settings.pseudo_count), PLACES).T
    objects = sum(bool(labels_of(one, action.name, sensor)) for one in specimens)
    empty = int((counts.sum(axis=1) == 0).sum())
    note = f"{empty} of {len(counts)} true states never tried: uniform" if empty else ""
    part = SensorPart(counts, objects, int(counts.sum()), note=note)
    return replace(action, sensor=replace(sensor, table=table)), part
