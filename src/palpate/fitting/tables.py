"""Tables of probabilities from counts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.fitting.data import Specimen
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Label

__all__ = ["dirichlet_mean", "labels_of", "looks", "seen", "state_counts"]

Array = NDArray[np.float64]
Counts = NDArray[np.int64]


def dirichlet_mean(counts: Array | Counts, pseudo_count: float) -> Array:
    """Probabilities along the last axis: the mean of the posterior of a symmetric Dirichlet prior.

    Source: Laplace's rule in general, (n_k + a) / (n + K a), as in Gelman et al. (2013), Bayesian Data Analysis, 3.4.

    Parameters
    ----------
    counts
        How often each was seen (..., K).
    pseudo_count
        What is added to each, above zero. Large ones give the uniform distribution.

    Examples
    --------
    >>> dirichlet_mean(np.array([3, 0]), 0.5).tolist()
    [0.875, 0.125]
    """
    smoothed = counts + pseudo_count
    return np.asarray(smoothed / smoothed.sum(axis=-1, keepdims=True))


def state_counts(network: Network, prop: CategoricalProperty, specimens: Sequence[Specimen]) -> Counts:
    """Objects of each state given the states of the parents, an axis for each parent and the states last."""
    axes = [*(network.property(name) for name in prop.parents), prop]
    states = [axis.states for axis in axes if isinstance(axis, CategoricalProperty)]
    counts = np.zeros([len(names) for names in states], dtype=np.int64)
    for one in specimens:
        if all(axis.name in one.truth for axis in axes):
            place = [names.index(str(one.truth[axis.name])) for axis, names in zip(axes, states, strict=True)]
            counts[tuple(place)] += 1
    return counts


def labels_of(specimen: Specimen, action: str, sensor: ConfusionSensor) -> list[str]:
    """The labels that an action gave on an object whose state is known; none where it is not."""
    if sensor.property not in specimen.truth:
        return []
    return [outcome.label for outcome in specimen.readings.get(action, ()) if isinstance(outcome, Label)]


def looks(
    network: Network, action: str, sensor: ConfusionSensor, specimens: Sequence[Specimen]
) -> tuple[Counts, Array]:
    """How often each outcome was seen for each true state, states x outcomes: as counted, and in independent looks.

    Where looks at one object repeat a hidden label with probability r, two of them agree with a correlation of r^2:
    n looks at an object count as n / (1 + (n - 1) r^2).

    Source: the design effect of Kish (1965), Survey Sampling, section 5.4.
    """
    measured = network.property(sensor.property)
    assert isinstance(measured, CategoricalProperty)
    counts = np.zeros((len(measured.states), len(sensor.outcomes)), dtype=np.int64)
    weights = np.zeros(counts.shape)
    for state, places in seen(measured, action, sensor, specimens):
        share = 1 / (1 + (len(places) - 1) * sensor.repeat_probability**2)
        np.add.at(counts[state], places, 1)
        np.add.at(weights[state], places, share)
    return counts, weights


def seen(
    measured: CategoricalProperty, action: str, sensor: ConfusionSensor, specimens: Sequence[Specimen]
) -> Iterator[tuple[int, list[int]]]:
    """Of each object that was looked at, its state and the outcomes, as places in their lists."""
    for one in specimens:
        labels = labels_of(one, action, sensor)
        if labels:
            state = measured.states.index(str(one.truth[sensor.property]))
            yield state, [sensor.outcomes.index(label) for label in labels]
