"""Outcomes from the entries of upload dictionaries; each decision is added to a list of texts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from palpate.inference.exact import ExactBelief
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty
from palpate.outcomes import Failed, Label, Outcome, Posterior, Reading
from palpate.store.importing.upload_format import Conventions, UploadDictionary

__all__ = ["averaged_outcome", "classified_outcome", "measured_outcome"]


def measured_outcome(dictionary: UploadDictionary, conventions: Conventions, decisions: list[str]) -> Outcome:
    """Take a continuous entry: its mean is the reading, the sensor model has its own SD."""
    value = dictionary.first_value()
    mean, unit = value.get("mean"), value.get("units")
    if not isinstance(mean, int | float) or not math.isfinite(mean):
        decisions.append(f"the entry's mean is {mean} and not a number: this is a failed reading")
        return Failed(f"the entry's mean is {mean}")
    if unit is None:
        unit = conventions.units.get(str(dictionary.at("entry", "name")))
        decisions.append(f"the entry gives no unit: {unit or 'that of the property'} is assumed")
    decisions.append(f"the entry's std {value.get('std')} is kept and not used: the sensor model has its own SD")
    return Reading(float(mean), unit=unit)


def averaged_outcome(
    dictionary: UploadDictionary,
    samples: Sequence[float],
    channel: str,
    unit: str,
    decisions: list[str],
) -> Outcome:
    """Take the mean of a series where the entry was derived from it."""
    if not samples or not all(math.isfinite(sample) for sample in samples):
        decisions.append(f"{channel} has no samples or some that are not finite: this is a failed reading")
        return Failed(f"no usable samples of {channel}")
    value = dictionary.first_value()
    derived = f"mean {value.get('mean')}, std {value.get('std')}"
    decisions.append(
        f"the outcome is the mean of {len(samples)} samples of {channel} in {unit}, with the sensor model's SD; "
        f"the entry ({derived}) is derived and not measured: it is kept and never used as evidence"
    )
    return Reading(math.fsum(samples) / len(samples), unit=unit)


def classified_outcome(
    dictionary: UploadDictionary,
    network: Network,
    action: Action,
    conventions: Conventions,
    labels: bool,
    decisions: list[str],
) -> Outcome:
    """Take a classifier's probabilities, or its most probable label."""
    found = dictionary.probabilities()
    if labels:
        return _labelled(action, found, conventions, decisions)
    measured = network.property(action.sensor.property)
    assert isinstance(measured, CategoricalProperty)
    for label, group in conventions.groups.items():
        if label in found and label not in measured.states and set(group) <= set(measured.states):
            found |= _split(network, measured, found.pop(label), label, group, decisions)
    unknown = {label: p for label, p in found.items() if label not in measured.states}
    if unknown:
        held = [f"{label!r} {p:.4f}" for label, p in unknown.items() if p > 0]
        silent = len(unknown) - len(held)
        told = ", ".join([*held, f"{silent} of probability zero"] if silent else held)
        decisions.append(f"labels that are no states of {measured.name} ({told}) are kept, and spread when admitted")
    return Posterior(found)


def _split(
    network: Network,
    measured: CategoricalProperty,
    probability: float,
    label: str,
    group: Sequence[str],
    decisions: list[str],
) -> dict[str, float]:
    """Share a label's probability among the states it stands for, in proportion to their prior."""
    prior = ExactBelief(network).probabilities(measured.name)
    weights = {state: float(prior[measured.states.index(state)]) for state in group}
    total = sum(weights.values())
    shares = {state: probability * weight / total for state, weight in weights.items()}
    told = ", ".join(f"{state} {shares[state]:.4f} (prior {weights[state]:.4f})" for state in group)
    decisions.append(
        f"{label!r} {probability:.4f} is split by the prior of network {network.name!r}: {told}; "
        f"as a label it would be the outcome {group[0]!r}"
    )
    return shares


def _labelled(action: Action, found: Mapping[str, float], conventions: Conventions, decisions: list[str]) -> Outcome:
    label = max(found, key=lambda name: found[name])
    outcomes = getattr(action.sensor, "outcomes", ())
    if label in conventions.groups and label not in outcomes:
        decisions.append(f"label {label!r} is the outcome {conventions.groups[label][0]!r}")
        label = conventions.groups[label][0]
    if label in outcomes:
        return Label(label)
    decisions.append(f"the most probable label {label!r} is no outcome of the action: this is a failed reading")
    return Failed(f"label {label!r} is not known")
