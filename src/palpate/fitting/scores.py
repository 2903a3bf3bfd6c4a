"""Whether a fit is worth it: its log score on objects that it has not seen, beside that of the template.

Objects are dealt into folds; each fold is scored by the network that was fitted to all others. The unit is the object:
of several readings of one the mean counts. The log score is strictly proper (Gneiting and Raftery 2007): no other
network scores better in the long run than the true one. Values that the fit to all objects leaves out are not scored: a
single slip of the pen would outweigh all others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean, stdev

import numpy as np

from palpate.fitting.data import Specimen
from palpate.fitting.errors import FittingError
from palpate.fitting.fit import fit, fit_property
from palpate.fitting.readings import readings_of
from palpate.fitting.settings import Settings
from palpate.fitting.tables import labels_of
from palpate.fitting.template import Template
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.sensors import ConfusionSensor

__all__ = ["FLOOR", "Score", "folds_of", "held_out_scores", "log2_property", "log2_sensor"]

FLOOR = 1e-6
"""Smallest probability of a state or a label that is counted."""
TEMPLATE, MARGINAL = "template", "without parents"


@dataclass(frozen=True)
class Score:
    """The mean log score of a property or a sensor on held-out objects [bits per object].

    Attributes
    ----------
    fitted
        log2 of the probability, or of the density per unit of the property.
    objects
        On which it was scored.
    against
        What it is compared with: the template, or, where that says nothing, the property without its parents; empty
        where there is nothing to compare with.
    difference, se
        How much better the fit is, in the mean over objects, and the standard error of that.
    """

    fitted: float
    objects: int
    against: str = ""
    difference: float = math.nan
    se: float = math.nan


def folds_of(specimens: Sequence[Specimen], folds: int, seed: int = 0) -> list[list[Specimen]]:
    """Deal objects into folds of nearly the same size, by chance, the same for any order of the objects."""
    ordered = sorted(specimens, key=lambda one: one.name)
    shuffled = np.random.default_rng(seed).permutation(len(ordered)).tolist()
    dealt = [[ordered[place] for place in shuffled[fold::folds]] for fold in range(min(folds, len(ordered)))]
    return [fold for fold in dealt if fold]


def held_out_scores(
    template: Template,
    specimens: Sequence[Specimen],
    settings: Settings | None = None,
    folds: int = 10,
    told: Callable[[int, int], None] = lambda done, of: None,
) -> Mapping[tuple[str, str], Score]:
    """Score every property and sensor that was fitted, by (``property`` or ``action``, its name).

    Parameters
    ----------
    folds
        As many as there are objects, if these are fewer.
    told
        Is called with how many folds are done, and of how many.

    Raises
    ------
    FittingError
        `folds` is below two, or too few objects are left where some are held out.
    """
    if folds < 2:
        raise FittingError(f"folds: found {folds}; expected 2 at least")
    settings = settings or Settings()
    wrong = _left_out(template, specimens, settings)
    scores: dict[tuple[str, str], list[tuple[float, float]]] = {}
    dealt = folds_of(specimens, folds)
    for done, held in enumerate(dealt):
        told(done, len(dealt))
        names = {one.name for one in held}
        rest = [one for one in specimens if one.name not in names]
        network = _fitted(template, rest, settings)
        prior = _prior(template, rest, settings)
        for one in held:
            for key, score, before in _scored(network, prior, one):
                if (key, one.name) not in wrong:
                    scores.setdefault(key, []).append((score, before))
    keys = [("property", name) for name in template.network.properties]
    keys += [("action", name) for name in template.network.actions]
    return {key: _summary(template, key, scores[key]) for key in keys if key in scores and key[1] not in settings.keep}


def _left_out(
    template: Template, specimens: Sequence[Specimen], settings: Settings
) -> set[tuple[tuple[str, str], str]]:
    """Properties and sensors with the objects whose values are too far out."""
    whole = fit(template, specimens, settings)
    found = {(("property", name), thing) for name, part in whole.properties.items() for thing in part.left_out}
    return found | {(("action", name), thing) for name, part in whole.actions.items() for thing in part.left_out}


def _fitted(template: Template, specimens: Sequence[Specimen], settings: Settings) -> Network:
    try:
        return fit(template, specimens, settings).network
    except FittingError as error:
        raise FittingError(f"folds: with some objects held out, {error}; expected more objects, or no folds") from None


def _prior(template: Template, specimens: Sequence[Specimen], settings: Settings) -> Network:
    """The template; properties about which it says nothing are fitted without parents."""
    network = template.network
    properties = dict(network.properties)
    for name in template.blank_properties:
        prop = properties[name]
        bare: CategoricalProperty | ContinuousProperty
        if isinstance(prop, CategoricalProperty):
            bare = replace(prop, parents=(), table=np.full(len(prop.states), 1 / len(prop.states)))
        elif isinstance(prop, ContinuousProperty):
            first = tuple(0 for _ in prop.parents)
            columns = {key: np.asarray(value)[first] for key, value in vars(prop.family).items()}
            bare = replace(prop, parents=(), family=replace(prop.family, **columns))  # type: ignore[type-var]
        else:
            continue
        properties[name], _ = fit_property(network, bare, specimens, settings)
    return replace(network, properties=properties)


def _scored(network: Network, prior: Network, one: Specimen) -> Iterator[tuple[tuple[str, str], float, float]]:
    for name, prop in network.properties.items():
        before = prior.properties[name]
        if not isinstance(prop, CategoricalProperty | ContinuousProperty) or name not in one.truth:
            continue
        if all(parent in one.truth for parent in prop.parents):
            assert isinstance(before, CategoricalProperty | ContinuousProperty)
            yield ("property", name), log2_property(network, prop, one), log2_property(network, before, one)
    for name, action in network.actions.items():
        score = log2_sensor(network, action, one)
        if score is not None:
            yield ("action", name), score, log2_sensor(network, prior.actions[name], one) or 0.0


def log2_property(network: Network, prop: CategoricalProperty | ContinuousProperty, one: Specimen) -> float:
    """log2 of the probability, or density per unit, of an object's true value given the states of the parents."""
    place = []
    for name in prop.parents:
        parent = network.property(name)
        assert isinstance(parent, CategoricalProperty)
        place.append(parent.states.index(str(one.truth[name])))
    if isinstance(prop, CategoricalProperty):
        found = float(prop.table[(*place, prop.states.index(str(one.truth[prop.name])))])
        return math.log2(max(found, FLOOR))
    density = prop.family.log_density(np.array(float(one.truth[prop.name])))
    return float(density[tuple(place)]) / math.log(2)


def log2_sensor(network: Network, action: Action, one: Specimen) -> float | None:
    """log2 of the probability of the readings of an object given its true value, by reading; None without any."""
    sensor = action.sensor
    if isinstance(sensor, ConfusionSensor):
        labels = labels_of(one, action.name, sensor)
        measured = network.property(sensor.property)
        if not labels or not isinstance(measured, CategoricalProperty):
            return None
        state = measured.states.index(str(one.truth[sensor.property]))
        return math.log2(max(float(sensor.likelihood(labels)[state]), FLOOR ** len(labels))) / len(labels)
    readings = readings_of(action.name, sensor, [one])
    if not len(readings.value):
        return None
    ((truth, outcomes),) = readings.by_thing()
    return float(sensor.log_likelihood(outcomes, np.array([truth]))[0]) / math.log(2) / len(outcomes)


def _summary(template: Template, key: tuple[str, str], pairs: Sequence[tuple[float, float]]) -> Score:
    fitted = fmean(score for score, _ in pairs)
    blank = key[1] in (template.blank_properties if key[0] == "property" else template.blank_actions)
    if blank and key[0] == "action":
        return Score(fitted, len(pairs))
    differences = [score - before for score, before in pairs]
    se = stdev(differences) / math.sqrt(len(pairs)) if len(pairs) > 1 else math.nan
    return Score(fitted, len(pairs), MARGINAL if blank else TEMPLATE, fmean(differences), se)
