"""Densities of a continuous property, one for each configuration of its parents.

What few objects of a configuration cannot say, all objects say together: the location of a configuration is drawn, with
the weight of one value of the spread of all, to the location of all, and its spread to that of values about the middle
of their own configuration, whose logarithm it has with an SD of 0.5 (a normal and a lognormal prior; the mode of the
posterior). A configuration without objects has the density of all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palpate.fitting.data import Specimen
from palpate.fitting.forms import Form, form_of
from palpate.fitting.likelihood import Prior, Sample, most_likely
from palpate.fitting.parts import PropertyPart
from palpate.fitting.robust import NORMAL, estimate, resolution
from palpate.network.families import Family, Gamma, LogNormal, Normal, StudentT
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty

__all__ = ["TOO_FEW", "fit_density"]

Array = NDArray[np.float64]
Place = tuple[int, ...]

TOO_FEW = 3
"""Values, of which two differ, are the fewest from which densities are estimated."""
DIGITS = 6
FAMILIES = {"mean": Normal, "median": LogNormal, "shape": Gamma, "location": StudentT}


@dataclass(frozen=True)
class Group:
    """The values of the objects of one configuration, and the objects' names."""

    values: Array
    names: tuple[str, ...]


def fit_density(
    network: Network, prop: ContinuousProperty, specimens: Sequence[Specimen]
) -> tuple[ContinuousProperty, PropertyPart]:
    """Fit a property; it stays as it is where there are too few values, and the part has no counts then."""
    groups = _groups(network, prop, specimens)
    shape = np.shape(prop.family.low)
    everything = np.concatenate([group.values for group in groups.values()]) if groups else np.empty(0)
    whole = form_of(prop.family, None)
    counts = np.zeros(shape, dtype=np.int64)
    for place, group in groups.items():
        counts[place] = len(group.values)
    if whole is None:
        return prop, PropertyPart(counts, int(counts.sum()), note="limits as in the template")
    if len(everything) < TOO_FEW or np.ptp(everything) == 0:
        return prop, PropertyPart(None, len(everything))
    fitted, left_out = _fit(prop, whole, groups)
    part = PropertyPart(counts, int(counts.sum()), tuple(sorted(left_out)), _note(counts))
    return replace(prop, family=_family(prop.family, fitted, shape)), part


def _groups(network: Network, prop: ContinuousProperty, specimens: Sequence[Specimen]) -> dict[Place, Group]:
    states = [p.states for p in map(network.property, prop.parents) if isinstance(p, CategoricalProperty)]
    found: dict[Place, list[tuple[float, str]]] = {}
    for one in specimens:
        if all(name in one.truth for name in (prop.name, *prop.parents)):
            parts = zip(states, prop.parents, strict=True)
            place = tuple(names.index(str(one.truth[parent])) for names, parent in parts)
            value = float(one.truth[prop.name])
            if prop.family.low[place] <= value <= prop.family.high[place]:
                found.setdefault(place, []).append((value, one.name))
    return {
        place: Group(np.array([value for value, _ in rows]), tuple(name for _, name in rows))
        for place, rows in sorted(found.items())
    }


def _fit(
    prop: ContinuousProperty, whole: Form, groups: Mapping[Place, Group]
) -> tuple[Mapping[Place | None, Mapping[str, float]], list[str]]:
    """Parameters by configuration, those of all under None; and the objects that were left out."""
    values = {place: whole.values(group.values) for place, group in groups.items()}
    floor = resolution(np.concatenate(list(values.values())))
    prior = _prior(whole, groups, values, floor) if prop.parents else None
    fitted: dict[Place | None, Mapping[str, float]] = {}
    left_out, kept = [], []
    for place, group in groups.items():
        form = form_of(prop.family, place)
        assert form is not None
        found = estimate(form, group.values, floor, prior)
        fitted[place] = form.parameters(found.location, found.spread)
        left_out += [name for name, used in zip(group.names, found.used, strict=True) if not used]
        kept.append(group.values[found.used])
    if prop.parents:
        fitted[None] = whole.parameters(*_together(whole, np.sort(np.concatenate(kept)), floor))
    return fitted, left_out


def _together(form: Form, ranked: Array, floor: float) -> tuple[float, float]:
    """Location and spread of all values."""
    x = form.values(ranked)
    return most_likely(form, Sample(ranked), (float(x.mean()), max(float(x.std()), floor)), floor)


def _prior(form: Form, groups: Mapping[Place, Group], values: Mapping[Place, Array], floor: float) -> Prior:
    """What all values say: their location and spread, and their spread about the middle of their configuration."""
    location, spread = _together(form, np.sort(np.concatenate([g.values for g in groups.values()])), floor)
    several = [x for x in values.values() if len(x) > 1]
    if not several:
        return Prior(location, spread, spread)
    off = np.concatenate([np.abs(x - np.median(x)) for x in several])
    # a middle that was fitted to the values is nearer to them than the true one
    own = NORMAL * float(np.median(off)) * np.sqrt(len(off) / (len(off) - len(several)))
    return Prior(location, spread, max(min(own, spread), floor))


def _family(family: Family, fitted: Mapping[Place | None, Mapping[str, float]], shape: Place) -> Family:
    keys = next(iter(fitted.values()))
    columns = {key: np.empty(shape) for key in keys}
    for place in np.ndindex(shape):
        for key, value in fitted.get(place, fitted.get(None, {})).items():
            columns[key][place] = float(f"{value:.{DIGITS}g}")
    return replace(family, **columns)  # type: ignore[type-var]


def _note(counts: NDArray[np.int64]) -> str:
    empty = int((counts == 0).sum())
    if not empty:
        return ""
    return f"{empty} of {counts.size} configurations without objects: the density of all"
